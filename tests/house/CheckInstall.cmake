# Installs the build folder BUILD into a fresh folder under WORK, moves it (an installed Lamella may be moved), and builds
# and runs the project CONSUMER against it. Fails when a library finds another by way of the build folder.
cmake_minimum_required(VERSION 3.25)

function(run what)
  execute_process(COMMAND ${ARGN} OUTPUT_VARIABLE output ERROR_VARIABLE output RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${what} failed (${status}):\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE "${WORK}")
run("installing" "${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${WORK}/first")
file(RENAME "${WORK}/first" "${WORK}/prefix")

foreach(file IN ITEMS
    "${LIBDIR}/cmake/lamella/LamellaConfig.cmake" "include/lamella/Version.h" "include/lamella/lbm/SteadyDiffusion.h")
  if(NOT EXISTS "${WORK}/prefix/${file}")
    message(FATAL_ERROR "${file} was not installed")
  endif()
endforeach()

# Public headers alone, and each with all that it includes.
if(EXISTS "${WORK}/prefix/include/lamella/lbm/multigrid/Multigrid.h")
  message(FATAL_ERROR "headers of our own were installed")
endif()
file(GLOB_RECURSE headers RELATIVE "${WORK}/prefix/include/lamella" "${WORK}/prefix/include/lamella/*.h")
list(FILTER headers INCLUDE REGEX "/") # VTK classes lie beside the folders
list(TRANSFORM headers REPLACE "(.+)" "#include \"\\1\"")
list(JOIN headers "\n" headers)
file(WRITE "${WORK}/AllHeaders.cpp" "${headers}\n")

set(options "-DCMAKE_PREFIX_PATH=${WORK}/prefix" "-DCMAKE_CXX_COMPILER=${COMPILER}" "-DCMAKE_BUILD_TYPE=Release"
  "-DWITH_FILTERS=${WITH_FILTERS}" "-DALL_HEADERS=${WORK}/AllHeaders.cpp")
if(LAUNCHER)
  list(APPEND options "-DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}")
endif()
if(SANITIZE)
  list(APPEND options "-DCMAKE_CXX_FLAGS=-fsanitize=${SANITIZE}")
endif()
run("configuring the consumer" "${CMAKE_COMMAND}" -S "${CONSUMER}" -B "${WORK}/consumer" -G "${GENERATOR}" ${options})
run("building the consumer" "${CMAKE_COMMAND}" --build "${WORK}/consumer")
unset(ENV{LD_LIBRARY_PATH})
run("running the consumer of Lamella::Solvers" "${WORK}/consumer/use-solvers")
message(STATUS "${output}")
if(EXISTS "${WORK}/consumer/use-filters")
  run("running the consumer of Lamella::Filters" "${WORK}/consumer/use-filters")
  message(STATUS "${output}")
endif()
if(EXISTS "${WORK}/prefix/bin/lamella")
  run("the installed program" "${WORK}/prefix/bin/lamella" --version)
  message(STATUS "${output}")
endif()

# Every library and program of ours finds ours inside the installation.
file(GLOB_RECURSE binaries "${WORK}/prefix/*.so" "${WORK}/prefix/bin/lamella")
foreach(binary IN LISTS binaries)
  execute_process(COMMAND ldd "${binary}" OUTPUT_VARIABLE needs ERROR_QUIET)
  string(REGEX MATCHALL "[^\n]*(amella)[^\n]*" ours "${needs}")
  foreach(line IN LISTS ours)
    string(STRIP "${line}" line)
    if(line MATCHES "not found" OR (line MATCHES "=> (/[^ ]*)" AND NOT CMAKE_MATCH_1 MATCHES "^${WORK}/prefix/"))
      message(FATAL_ERROR "${binary} does not find its library in the installation: ${line}")
    endif()
  endforeach()
endforeach()
file(REMOVE_RECURSE "${WORK}")
