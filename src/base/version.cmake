# Run at every build: generates OUTPUT from version.cpp.in; configure_file rewrites it only if the revision changed.
execute_process(COMMAND git describe --always --dirty --abbrev=12 WORKING_DIRECTORY ${CMAKE_CURRENT_LIST_DIR}
                OUTPUT_VARIABLE REVISION OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
set(REVISION_TEXT " (${REVISION})")
if(failed) # no repository: a tarball
  set(REVISION_TEXT "")
endif()
configure_file(${CMAKE_CURRENT_LIST_DIR}/version.cpp.in ${OUTPUT} @ONLY)
