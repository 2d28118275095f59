# Debian 13 renames ParaView's Python modules (x.so becomes x.cpython-313-x86_64-linux-gnu.so) once CMake has written
# down their names, and find_package(ParaView) stops where they are not. Nothing here links them. CMake itself passes over
# what stands in an xcframework, so each of them is said to. Installed beside LamellaConfig.cmake, which needs it too.
file(GLOB _lamella_targets "/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/paraview-*/*Python*-targets-*.cmake"
  "/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/paraview-*/vtk/*Python*-targets-*.cmake")
foreach(_lamella_file IN LISTS _lamella_targets)
  file(STRINGS "${_lamella_file}" _lamella_lines REGEX "APPEND _cmake_import_check_targets")
  foreach(_lamella_line IN LISTS _lamella_lines)
    if(_lamella_line MATCHES "_cmake_import_check_targets ([A-Za-z0-9_]+::[A-Za-z0-9_.]+)")
      set(_cmake_import_check_xcframework_for_${CMAKE_MATCH_1} "${CMAKE_CURRENT_LIST_DIR}")
    endif()
  endforeach()
endforeach()
