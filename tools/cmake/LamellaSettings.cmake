# Language, warnings, sanitizers and output folders: the same for every target of ours.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

set(BUILD_SHARED_LIBS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/bin")
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/lib")
set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/lib")
set(CMAKE_INSTALL_RPATH_USE_LINK_PATH ON) # ParaView or MPI outside the system's folders
set(CMAKE_INSTALL_RPATH "$ORIGIN;$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${CCACHE_PROGRAM}")
  set(CMAKE_C_COMPILER_LAUNCHER "${CCACHE_PROGRAM}")
endif()

# Several sources of a folder at a time: most of a file's time goes into headers and into templates of theirs, which
# neighbours share. Half the processor time of a build from nothing; OFF where single files are compiled again and again.
# Names in unnamed namespaces differ within a folder therefore. A new source moves its own folder's groups only. Sources
# with options of their own are compiled by themselves.
option(LAMELLA_UNITY "Compile several sources at a time" ON)
function(lamella_unity target)
  if(LAMELLA_UNITY)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
    # One source that is included in another is no header, and its names no business of its neighbours'.
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
    cmake_language(EVAL CODE # when all folders have given theirs
      "cmake_language(DEFER DIRECTORY [[${PROJECT_SOURCE_DIR}]] CALL _lamella_unity_groups ${target})")
  endif()
endfunction()

function(_lamella_unity_groups target)
  get_target_property(sources ${target} SOURCES)
  get_target_property(base ${target} SOURCE_DIR)
  list(FILTER sources INCLUDE REGEX "[.](cpp|cxx)$")
  foreach(source IN LISTS sources)
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY "${base}" NORMALIZE)
    cmake_path(GET source PARENT_PATH folder)
    file(RELATIVE_PATH folder "${PROJECT_SOURCE_DIR}" "${folder}")
    string(MAKE_C_IDENTIFIER "${folder}" key)
    math(EXPR _count_${key} "0${_count_${key}} + 1")
    math(EXPR group "(${_count_${key}} - 1) / 8")
    set_source_files_properties("${source}" TARGET_DIRECTORY ${target} PROPERTIES UNITY_GROUP "${key}_${group}")
  endforeach()
endfunction()

# Warnings for hand-written code only: wrapping and plugin code that CMake generates is not ours to mend.
function(lamella_warnings target)
  lamella_unity(${target})
  target_compile_options(${target} PRIVATE
    $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wpedantic -Wshadow$<$<BOOL:${LAMELLA_UNITY}>:=local> -Wnon-virtual-dtor -Wcast-align
    -Woverloaded-virtual -Wvla>)
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 13)
    # It takes what returns a reference into a static table for what returns one of its temporary arguments.
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-Wno-dangling-reference>)
  endif()
  if(LAMELLA_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-Werror>)
  endif()
  if(LAMELLA_SANITIZE AND NOT LAMELLA_SANITIZE_SOURCES) # with instrumented code g++ 12 sees uninitialised values in its own <regex> and <functional>
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-Wno-maybe-uninitialized>)
  endif()
endfunction()

if(LAMELLA_SANITIZE)
  add_link_options(-fsanitize=${LAMELLA_SANITIZE})
  if(LAMELLA_SANITIZE_ALL)
    add_compile_options(-fsanitize=${LAMELLA_SANITIZE} -fno-omit-frame-pointer)
  endif()
endif()

# Of a tree that is not instrumented as a whole, the targets that are: what reads files and what computes. They assert,
# too, and the containers of the standard library check their indices.
set(LAMELLA_SANITIZE_FLAGS -fsanitize=${LAMELLA_SANITIZE} -fno-omit-frame-pointer -O1 -g1 -UNDEBUG -D_GLIBCXX_ASSERTIONS)
function(lamella_sanitize target)
  if(NOT LAMELLA_SANITIZE OR LAMELLA_SANITIZE_ALL)
    return()
  endif()
  if(LAMELLA_SANITIZE_SOURCES) # when all folders have given theirs
    cmake_language(EVAL CODE
      "cmake_language(DEFER DIRECTORY [[${PROJECT_SOURCE_DIR}]] CALL _lamella_sanitize_sources ${target})")
  else()
    target_compile_options(${target} PRIVATE ${LAMELLA_SANITIZE_FLAGS})
  endif()
endfunction()

function(_lamella_sanitize_sources target)
  get_target_property(sources ${target} SOURCES)
  get_target_property(folder ${target} SOURCE_DIR)
  foreach(source IN LISTS sources)
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY "${folder}" OUTPUT_VARIABLE path)
    if(path MATCHES "${LAMELLA_SANITIZE_SOURCES}" AND NOT source MATCHES "^\\$<")
      set_property(SOURCE "${path}" TARGET_DIRECTORY ${target} APPEND PROPERTY COMPILE_OPTIONS
        ${LAMELLA_SANITIZE_FLAGS} -Wno-maybe-uninitialized)
    endif()
  endforeach()
endfunction()

# Of an instrumented target, sources whose sums are expressions of Eigen on small matrices: the undefined-behaviour
# sanitizer looks at each pointer and reference in such an expression, some hundred a product, and keeps its parts in
# memory. Without these looks they take a tenth of the time, and the address sanitizer still sees each access.
function(lamella_sanitize_accesses target)
  if(LAMELLA_SANITIZE MATCHES undefined AND NOT LAMELLA_SANITIZE_ALL AND NOT LAMELLA_SANITIZE_SOURCES)
    set_property(SOURCE ${ARGN} TARGET_DIRECTORY ${target} APPEND PROPERTY COMPILE_OPTIONS
      -O2 -fno-sanitize-address-use-after-scope -fno-sanitize=null,alignment,object-size,pointer-overflow)
  endif()
endfunction()
