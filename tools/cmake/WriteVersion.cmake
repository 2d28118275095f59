# Run with cmake -P at build time (LamellaVersion.cmake): writes OUTPUT from TEMPLATE, and only when it changed.
set(COMMIT "unknown")
set(_archived "$Format:%H$") # `git archive` puts the commit here (.gitattributes: export-subst)
if(_archived MATCHES "^([0-9a-f][0-9a-f][0-9a-f][0-9a-f][0-9a-f][0-9a-f][0-9a-f][0-9a-f][0-9a-f][0-9a-f][0-9a-f][0-9a-f])")
  set(COMMIT "${CMAKE_MATCH_1}")
endif()
# Only a clone of our own counts, not some repository that the sources were unpacked into.
if(GIT AND EXISTS "${SOURCE_DIR}/.git")
  execute_process(
    COMMAND "${GIT}" -c "safe.directory=${SOURCE_DIR}" -C "${SOURCE_DIR}" describe --always --dirty --abbrev=12 --exclude=*
    OUTPUT_VARIABLE _described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE _failed)
  if(NOT _failed AND _described)
    set(COMMIT "${_described}")
  endif()
endif()
configure_file("${TEMPLATE}" "${OUTPUT}" @ONLY)
