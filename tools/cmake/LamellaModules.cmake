# The VTK modules, each a folder with a vtk.module file: solvers/vtk, filters, filters/rendering. Then their Python
# wrapping and the ParaView plugin.
set(_module_files)
foreach(folder solvers/vtk filters filters/rendering)
  if(EXISTS "${CMAKE_CURRENT_SOURCE_DIR}/${folder}/vtk.module")
    list(APPEND _module_files "${CMAKE_CURRENT_SOURCE_DIR}/${folder}/vtk.module")
  endif()
endforeach()
if(NOT _module_files)
  return()
endif()
vtk_module_scan(MODULE_FILES ${_module_files}
  PROVIDES_MODULES LAMELLA_VTK_MODULES
  WANT_BY_DEFAULT ON ENABLE_TESTS OFF)
vtk_module_build(MODULES ${LAMELLA_VTK_MODULES}
  PACKAGE LamellaVTK INSTALL_EXPORT LamellaVTK
  HEADERS_DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/lamella"
  CMAKE_DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/lamella"
  ENABLE_WRAPPING ${LAMELLA_BUILD_PYTHON})

# lamella_module(NAME Lamella::Filters CLASSES vtkA ... [PRIVATE_SOURCES ...]): a VTK module with our warnings.
