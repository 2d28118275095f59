# Version and commit, for `lamella --version` and for the provenance in every file that is written.
#
#   #include "lamella/Version.h"     lamella::version(), lamella::commit()
#
# The header never changes between commits; only one small source does, which is written anew at build time, so that
# a commit rebuilds one file. It is compiled into Lamella::Solvers, and what links that library has it.
set(_generated "${PROJECT_BINARY_DIR}/generated")
configure_file("${CMAKE_CURRENT_LIST_DIR}/Version.h.in" "${_generated}/lamella/Version.h" @ONLY)

find_package(Git QUIET)
add_custom_target(lamella_version
  COMMAND ${CMAKE_COMMAND}
    "-DGIT=${GIT_EXECUTABLE}"
    "-DSOURCE_DIR=${PROJECT_SOURCE_DIR}"
    "-DTEMPLATE=${CMAKE_CURRENT_LIST_DIR}/Version.cpp.in"
    "-DOUTPUT=${_generated}/Version.cpp"
    "-DVERSION=${PROJECT_VERSION}"
    -P "${CMAKE_CURRENT_LIST_DIR}/WriteVersion.cmake"
  BYPRODUCTS "${_generated}/Version.cpp"
  COMMENT "Reading the commit" VERBATIM)
set(LAMELLA_VERSION_SOURCE "${_generated}/Version.cpp")
set(LAMELLA_GENERATED_INCLUDE_DIR "${_generated}")
