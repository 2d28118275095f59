# The layers point one way: no file in solvers/, but those in solvers/vtk/, includes a header of VTK or ParaView.
#
#   cmake -DROOT=<sources> -P CheckLayers.cmake
#
# First it proves on files of its own that it finds what it is looking for; then it reads the sources.
cmake_minimum_required(VERSION 3.25)

# Lines of the files under `folder`/solvers that break the rule, as "path: line".
function(vtk_includes folder result)
  set(found)
  file(GLOB_RECURSE files LIST_DIRECTORIES false RELATIVE "${folder}" "${folder}/solvers/*")
  list(FILTER files INCLUDE REGEX "\\.(h|hpp|hxx|ipp|inl|txx|c|cc|cpp|cxx|cu|in)$")
  list(FILTER files EXCLUDE REGEX "^solvers/vtk/")
  foreach(file IN LISTS files)
    file(STRINGS "${folder}/${file}" lines
      REGEX "^[ \t]*#[ \t]*(include|include_next|import)[ \t]*[<\"]([^<>\"]*/)?(vtk|pq|[Pp]ara[Vv]iew)[^<>\"]*[>\"]")
    foreach(line IN LISTS lines)
      list(APPEND found "${file}: ${line}")
    endforeach()
  endforeach()
  list(LENGTH files count)
  set(${result} "${found}" PARENT_SCOPE)
  set(${result}_files ${count} PARENT_SCOPE)
endfunction()

# The check of the check.
string(RANDOM LENGTH 8 unique)
set(probe "${CMAKE_CURRENT_BINARY_DIR}/layers-${unique}") # in a script: the folder it was started in
set(bad
  "#include <vtkImageData.h>"
  "#include \"vtkImageData.h\""
  "  #  include <vtk/vtkNew.h>"
  "#include \"vtk/vtkLatticeConversion.h\""
  "#include \"../vtk/Conversion.h\""
  "#include <vtk_eigen.h>"
  "#include <vtksys/SystemTools.hxx>"
  "#include <pqApplicationCore.h>"
  "#include <paraview/vtkPVConfig.h>")
set(good
  "#include <vector>"
  "#include \"lattice/Phases.h\""
  "#include \"lattice/NotAvtkHeader.h\""
  "// #include <vtkImageData.h> is what this file must not do"
  "const char* text = \"#include <vtkImageData.h>\"\;")
set(number 0)
foreach(line IN LISTS bad)
  math(EXPR number "${number} + 1")
  file(WRITE "${probe}/solvers/lbm/bad${number}.h" "#pragma once\n${line}\n")
endforeach()
foreach(line IN LISTS good)
  file(APPEND "${probe}/solvers/lbm/good.cpp" "${line}\n")
endforeach()
file(WRITE "${probe}/solvers/vtk/vtkAllowed.h" "#include <vtkImageData.h>\n")
vtk_includes("${probe}" probed)
file(REMOVE_RECURSE "${probe}")
list(LENGTH bad expected)
list(LENGTH probed caught)
if(NOT caught EQUAL expected OR probed MATCHES "good|Allowed")
  list(JOIN probed "\n  " probed)
  message(FATAL_ERROR "the check itself is wrong: it should find ${expected} bad lines, and found:\n  ${probed}")
endif()

vtk_includes("${ROOT}" found)
if(found_files EQUAL 0)
  message(FATAL_ERROR "no source found in ${ROOT}/solvers")
endif()
if(found)
  list(JOIN found "\n  " found)
  message(FATAL_ERROR "the numerics must know nothing of VTK (docs/architecture.md); move this to solvers/vtk/:\n  ${found}")
endif()
message(STATUS "${found_files} files of the numerics include no VTK header")
