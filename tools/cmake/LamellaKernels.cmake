# Loops compiled once for every instruction set and chosen at run time.
#
#   lamella_kernels(TARGET source table [dispatcher])
#     Compiles `source` as the object libraries TARGETBase, TARGETV3 (AVX2) and TARGETV4 (AVX-512) into LamellaSolvers.
#     LAMELLA_KERNELS is defined as <table>Base … and LAMELLA_KERNELS_NAME as the set's name. folder/XImpl.cpp defines
#     an X, which folder/X.h declares; `const X& table()`, the fastest that the processor runs, is made of
#     KernelChoice.cpp.in unless `dispatcher` is a source of its own that chooses; it has LAMELLA_X86_KERNELS where the
#     wider sets exist.
function(_lamella_kernel_set target source table suffix name)
  set(lib ${target}${suffix})
  add_library(${lib} OBJECT "${source}")
  target_include_directories(${lib} PRIVATE "${PROJECT_SOURCE_DIR}/solvers")
  target_compile_definitions(${lib} PRIVATE LAMELLA_KERNELS=${table}${suffix} LAMELLA_KERNELS_NAME="${name}")
  # no effect on results beyond round-off: fused multiply-add, no errno, loops may be vectorised; the vector ABI does
  # not matter where everything is inlined
  target_compile_options(${lib} PRIVATE -O3 -fopenmp-simd -fno-math-errno -fno-trapping-math -ffp-contract=fast
    -Wno-psabi ${ARGN})
  lamella_warnings(${lib})
  lamella_sanitize(${lib})
  target_sources(LamellaSolvers PRIVATE $<TARGET_OBJECTS:${lib}>)
endfunction()

function(lamella_kernels target source table)
  if(ARGN)
    set(dispatcher "${ARGN}")
  else()
    cmake_path(GET CMAKE_CURRENT_SOURCE_DIR FILENAME SPACE)
    string(REGEX REPLACE "Impl\\.cpp$" "" name "${source}")
    set(HEADER "${SPACE}/${name}.h")
    cmake_path(GET name FILENAME TYPE)
    set(TABLE ${table})
    set(dispatcher "${CMAKE_CURRENT_BINARY_DIR}/${TYPE}.cpp")
    configure_file("${PROJECT_SOURCE_DIR}/tools/cmake/KernelChoice.cpp.in" "${dispatcher}" @ONLY)
    target_sources(LamellaSolvers PRIVATE "${dispatcher}")
  endif()
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    _lamella_kernel_set(${target} "${source}" ${table} Base x86-64)
    _lamella_kernel_set(${target} "${source}" ${table} V3 x86-64-v3 -march=x86-64-v3)
    _lamella_kernel_set(${target} "${source}" ${table} V4 x86-64-v4 -march=x86-64-v4 -mprefer-vector-width=512)
    set_source_files_properties("${dispatcher}" TARGET_DIRECTORY LamellaSolvers
      PROPERTIES COMPILE_DEFINITIONS LAMELLA_X86_KERNELS)
  else()
    _lamella_kernel_set(${target} "${source}" ${table} Base generic)
  endif()
endfunction()
