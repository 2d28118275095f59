# Run at every build: writes io/Version.h with the version and the commit, and touches it only when they changed.
# -D SOURCE=<source folder> -D OUTPUT=<Version.h> -D VERSION=<x.y.z> [-D COMMIT=<what to say instead of asking git>]
if(NOT COMMIT)
  set(COMMIT "unknown")
  find_program(GIT_EXECUTABLE git)
  if(GIT_EXECUTABLE)
    # safe.directory: the checkout may belong to another user than the one who builds (in a container, say).
    execute_process(COMMAND "${GIT_EXECUTABLE}" -c "safe.directory=*" rev-parse --short=10 HEAD
      WORKING_DIRECTORY "${SOURCE}" OUTPUT_VARIABLE hash RESULT_VARIABLE failed
      OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    execute_process(COMMAND "${GIT_EXECUTABLE}" -c "safe.directory=*" status --porcelain --untracked-files=no
      WORKING_DIRECTORY "${SOURCE}" OUTPUT_VARIABLE changes ERROR_QUIET)
    # Unpacked sources inside somebody else's checkout must not take that one's commit.
    execute_process(COMMAND "${GIT_EXECUTABLE}" -c "safe.directory=*" rev-parse --show-toplevel
      WORKING_DIRECTORY "${SOURCE}" OUTPUT_VARIABLE toplevel OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    file(REAL_PATH "${SOURCE}" source)
    if(NOT failed AND toplevel STREQUAL source)
      set(COMMIT "${hash}")
      if(changes)
        string(APPEND COMMIT "-dirty")
      endif()
    endif()
  endif()
endif()
file(CONFIGURE OUTPUT "${OUTPUT}" @ONLY CONTENT "#pragma once
#define LAMELLA_VERSION \"@VERSION@\"
#define LAMELLA_COMMIT \"@COMMIT@\"
")
