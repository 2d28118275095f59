# Tests: one function a form, so that labels, time limits and environment are the same everywhere.
#
#   lamella_add_gtest(NAME source... LABEL kind [LIBS lib...] [MPI] [RANKS n...] [SLOW_RANKS n...] [WHOLE] [TIMEOUT seconds]
#                     [ENVIRONMENT A=b...])
#     A GoogleTest program, one ctest test a case. MPI: with a main() that starts and ends MPI. RANKS: the whole
#     program also runs under mpirun with each of these numbers of ranks, as NAME.ranks<n> (implies MPI). SLOW_RANKS: the
#     same with the label `slow`, where two cores have long to do and fewer ranks find most faults, too. WHOLE: all cases
#     in one ctest test, for many short ones, each of which would begin with the half second that MPI takes to start.
#
#   lamella_add_test(NAME name LABEL kind COMMAND command... [RANKS n] [TIMEOUT seconds] [ENVIRONMENT A=b...]
#                    [SKIP_RETURN_CODE n] [PASS_REGULAR_EXPRESSION re] [WILL_FAIL])
#     Any other program or script; with RANKS under mpirun.
#
# Every test runs with no DISPLAY (tests that want one start Xvfb), with passive OpenMP waiting (spinning threads cost
# far more on a shared machine), and in its own build folder. LAMELLA_REAL_DATA, which names the folder of real
# pictures, is passed through from the caller; tests that need it skip without it. The label `slow` can be added to
# another one (LABEL "verification;slow"); ./dev test leaves those out.
include(GoogleTest)
find_package(GTest 1.12 REQUIRED)

set(LAMELLA_TEST_TIMEOUT 120 CACHE STRING "Seconds after which a test counts as failed")
set(_lamella_test_environment
  OMP_WAIT_POLICY=PASSIVE
  OMPI_ALLOW_RUN_AS_ROOT=1
  OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
  OMPI_MCA_ess_singleton_isolated=1 # one rank alone: Open MPI 4 starts a daemon beside it otherwise
  OMPI_MCA_mpi_yield_when_idle=1 # more ranks than idle cores would spin: minutes in place of seconds
  # containers refuse the system call, and Open MPI 4 and 5 then complain
  OMPI_MCA_btl_vader_single_copy_mechanism=none
  OMPI_MCA_smsc=^cma
)
# One rank alone, without mpirun: Open MPI 4 else tries every transport first, which takes 0.15 s a start; and needs no folder of
# its session, whose making is a race among those that start at once.
set(_lamella_test_alone OMPI_MCA_pml=ob1 OMPI_MCA_orte_create_session_dirs=0)
if(LAMELLA_SANITIZE)
  # Leaks in Open MPI, ParaView and Python are not ours to mend; errors of ours end the program.
  list(APPEND _lamella_test_environment "ASAN_OPTIONS=detect_leaks=0" "UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1")
endif()

# Several tests at once on few cores: no binding, or all of them would share core 0.
set(LAMELLA_MPIEXEC "${MPIEXEC_EXECUTABLE}" --oversubscribe --bind-to none "${MPIEXEC_NUMPROC_FLAG}")

function(_lamella_test_properties tests label timeout environment)
  if(NOT timeout)
    set(timeout ${LAMELLA_TEST_TIMEOUT})
  endif()
  set_tests_properties(${tests} PROPERTIES
    LABELS "${label}" TIMEOUT "${timeout}"
    ENVIRONMENT "${_lamella_test_environment};${environment}"
    ENVIRONMENT_MODIFICATION "DISPLAY=unset:;WAYLAND_DISPLAY=unset:")
endfunction()

function(lamella_add_test)
  cmake_parse_arguments(PARSE_ARGV 0 arg "WILL_FAIL"
    "NAME;LABEL;RANKS;TIMEOUT;SKIP_RETURN_CODE;PASS_REGULAR_EXPRESSION;WORKING_DIRECTORY" "COMMAND;ENVIRONMENT")
  if(arg_UNPARSED_ARGUMENTS OR NOT arg_NAME OR NOT arg_LABEL OR NOT arg_COMMAND)
    message(FATAL_ERROR "lamella_add_test: NAME, LABEL and COMMAND are needed; not understood: '${arg_UNPARSED_ARGUMENTS}'")
  endif()
  if(NOT arg_WORKING_DIRECTORY)
    set(arg_WORKING_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}")
  endif()
  if(arg_RANKS)
    list(PREPEND arg_COMMAND ${LAMELLA_MPIEXEC} ${arg_RANKS})
  endif()
  add_test(NAME "${arg_NAME}" COMMAND ${arg_COMMAND} WORKING_DIRECTORY "${arg_WORKING_DIRECTORY}")
  _lamella_test_properties("${arg_NAME}" "${arg_LABEL}" "${arg_TIMEOUT}" "${arg_ENVIRONMENT}")
  if(arg_RANKS)
    set_tests_properties("${arg_NAME}" PROPERTIES PROCESSORS ${arg_RANKS})
  endif()
  foreach(property SKIP_RETURN_CODE PASS_REGULAR_EXPRESSION)
    if(DEFINED arg_${property})
      set_tests_properties("${arg_NAME}" PROPERTIES ${property} "${arg_${property}}")
    endif()
  endforeach()
  if(arg_WILL_FAIL)
    set_tests_properties("${arg_NAME}" PROPERTIES WILL_FAIL TRUE)
  endif()
endfunction()

# Tests spend little time in their own code, and their builds more than half of theirs in its optimisation.
# -Wno-dangling-else: GoogleTest's macros bring an else of their own, which is no danger.
function(lamella_build_fast target)
  target_compile_options(${target} PRIVATE -Wno-dangling-else)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

function(lamella_add_gtest NAME)
  cmake_parse_arguments(PARSE_ARGV 1 arg "MPI;WHOLE" "TIMEOUT" "LABEL;LIBS;RANKS;SLOW_RANKS;ENVIRONMENT")
  set(sources ${arg_UNPARSED_ARGUMENTS})
  if(NOT sources OR NOT arg_LABEL)
    message(FATAL_ERROR "lamella_add_gtest(${NAME}): sources and a LABEL are needed")
  endif()
  if(arg_MPI OR arg_RANKS OR arg_SLOW_RANKS)
    set(main lamella_mpi_main)
  else()
    set(main GTest::gtest_main)
  endif()
  add_executable(${NAME} ${sources})
  set_target_properties(${NAME} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin/tests")
  target_link_libraries(${NAME} PRIVATE ${arg_LIBS} ${main})
  lamella_warnings(${NAME})
  lamella_build_fast(${NAME})

  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT ${LAMELLA_TEST_TIMEOUT})
  endif()
  if(arg_WHOLE)
    lamella_add_test(NAME ${NAME} LABEL "${arg_LABEL}" TIMEOUT ${arg_TIMEOUT} ENVIRONMENT ${arg_ENVIRONMENT}
      COMMAND $<TARGET_FILE:${NAME}>)
  else()
    gtest_discover_tests(${NAME} NO_PRETTY_VALUES TEST_PREFIX "${NAME}." DISCOVERY_TIMEOUT 60 WORKING_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}" TEST_LIST ${NAME}_TESTS)
    # Lists with semicolons do not pass through gtest_discover_tests' PROPERTIES; so they are set once ctest knows the cases.
    set(script "${CMAKE_CURRENT_BINARY_DIR}/${NAME}_properties.cmake")
    file(CONFIGURE OUTPUT "${script}" @ONLY CONTENT [=[
if(@NAME@_TESTS)
  set_tests_properties(${@NAME@_TESTS} PROPERTIES
    LABELS "@arg_LABEL@" TIMEOUT "@arg_TIMEOUT@"
    ENVIRONMENT "@_lamella_test_environment@;@_lamella_test_alone@;@arg_ENVIRONMENT@"
    ENVIRONMENT_MODIFICATION "DISPLAY=unset:;WAYLAND_DISPLAY=unset:")
endif()
]=])
    set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES "${script}")
  endif()

  foreach(ranks IN LISTS arg_RANKS arg_SLOW_RANKS)
    set(label ${arg_LABEL})
    if(ranks IN_LIST arg_SLOW_RANKS)
      list(APPEND label slow)
    endif()
    lamella_add_test(NAME ${NAME}.ranks${ranks} LABEL "${label}" TIMEOUT ${arg_TIMEOUT} RANKS ${ranks}
      ENVIRONMENT ${arg_ENVIRONMENT} COMMAND $<TARGET_FILE:${NAME}>)
    # All cases skipped: say so, rather than "passed".
    set_tests_properties(${NAME}.ranks${ranks} PROPERTIES SKIP_REGULAR_EXPRESSION "\\[  PASSED  \\] 0 tests")
  endforeach()
endfunction()
