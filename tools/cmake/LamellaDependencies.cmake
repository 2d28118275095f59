# Every library we build with. One VTK a build (docs/architecture.md says why): the one inside ParaView, or with
# LAMELLA_PARAVIEW=OFF the system's.

if(LAMELLA_PARAVIEW)
  # Before ParaView, whose package looks for HDF5 too, and what is found first stays: ParaView links the Open MPI build, and
  # two HDF5 in one program do not mix. Debian 13 brings the serial one's headers along with paraview-dev. (The system's VTK
  # there links the serial one; with another VTK that does not: -DHDF5_PREFER_PARALLEL=ON.) From ParaView 6 on Debian's has
  # no VTK of its own, but takes the system's.
  file(GLOB _system_vtk "/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/vtk-9.[5-9]")
  if(NOT _system_vtk)
    set(HDF5_PREFER_PARALLEL ON)
  endif()
  include(LamellaParaView)
  find_package(ParaView 5.11 REQUIRED COMPONENTS RemotingCore) # its VTK, which it puts into VTK_DIR
endif()
set(LAMELLA_VTK_COMPONENTS # LamellaConfig.cmake asks for the same
  CommonCore CommonDataModel CommonExecutionModel CommonMath CommonColor FiltersCore FiltersFlowPaths FiltersGeneral
  FiltersGeometry FiltersSources FiltersExtraction ImagingCore InteractionStyle IOCore IOGeometry IOHDF IOImage
  IOInfovis IOOggTheora IOPLY IOXML IOXMLParser ParallelCore
  ParallelMPI RenderingAnnotation RenderingCore RenderingFreeType RenderingOpenGL2 RenderingContext2D
  RenderingContextOpenGL2 ChartsCore)
find_package(VTK 9.2 REQUIRED COMPONENTS ${LAMELLA_VTK_COMPONENTS})
# Up to VTK 9.4 a header of VTK has `nlohmann` mean the copy of that library inside VTK, in what we write too, and from
# ParaView 5.12 on others bring it along. Ours is the system's, in every file: VTK's macros are passed over.
add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-Dvtk_nlohmannjson_h>
  "$<$<COMPILE_LANGUAGE:CXX>:-DVTK_NLOHMANN_JSON(x)=<nlohmann/x$<ANGLE-R>>")

set(MPI_CXX_SKIP_MPICXX ON) # the C interface only
find_package(MPI REQUIRED COMPONENTS CXX)
find_package(Eigen3 REQUIRED NO_MODULE)
if(Eigen3_VERSION VERSION_LESS 3.4) # asked here: Eigen 5 says that it is no 3.4
  message(FATAL_ERROR "Eigen ${Eigen3_VERSION} is too old: 3.4 or later is needed")
endif()
find_package(HDF5 REQUIRED COMPONENTS C)
add_library(Lamella_hdf5 INTERFACE IMPORTED) # itself only: CMake's target lists all that the library was linked with
target_include_directories(Lamella_hdf5 SYSTEM INTERFACE ${HDF5_C_INCLUDE_DIRS})
if(HDF5_C_LIBRARY_hdf5)
  target_link_libraries(Lamella_hdf5 INTERFACE "${HDF5_C_LIBRARY_hdf5}" MPI::MPI_CXX)
else() # HDF5 2 has a CMake package, whose target is that alone
  target_link_libraries(Lamella_hdf5 INTERFACE ${HDF5_C_LIBRARIES} MPI::MPI_CXX)
endif()
find_package(OpenMP REQUIRED COMPONENTS CXX)
find_package(CLI11 REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(fmt REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(JPEG REQUIRED)
find_package(OpenSSL REQUIRED COMPONENTS Crypto) # SHA-256; HDF5 loads it anyway
find_package(PNG REQUIRED)
find_package(TIFF REQUIRED)
find_package(ZLIB REQUIRED)

# Debian has no CMake config for these three when only the needed parts are installed.
find_path(HYPRE_INCLUDE_DIR HYPRE.h PATH_SUFFIXES hypre REQUIRED)
find_library(HYPRE_LIBRARY HYPRE REQUIRED)
add_library(Lamella_hypre INTERFACE IMPORTED)
target_include_directories(Lamella_hypre SYSTEM INTERFACE "${HYPRE_INCLUDE_DIR}")
target_link_libraries(Lamella_hypre INTERFACE "${HYPRE_LIBRARY}" MPI::MPI_CXX)

find_path(CMARK_INCLUDE_DIR cmark.h REQUIRED)
find_library(CMARK_LIBRARY cmark REQUIRED)
add_library(Lamella_cmark INTERFACE IMPORTED)
target_include_directories(Lamella_cmark SYSTEM INTERFACE "${CMARK_INCLUDE_DIR}")
target_link_libraries(Lamella_cmark INTERFACE "${CMARK_LIBRARY}")

find_path(OpenCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
add_library(Lamella_opencv INTERFACE IMPORTED)
target_include_directories(Lamella_opencv SYSTEM INTERFACE "${OpenCV_INCLUDE_DIR}")
foreach(module core imgproc) # and no other: viz would bring Debian's own VTK along, imgcodecs GDAL and a second HDF5
  find_library(OpenCV_${module}_LIBRARY opencv_${module} REQUIRED)
  target_link_libraries(Lamella_opencv INTERFACE "${OpenCV_${module}_LIBRARY}")
endforeach()
