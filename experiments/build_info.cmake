# Run at every build (cmake -P): writes OUTPUT from TEMPLATE with the commit of SOURCE_DIR and what FACTS (a CMake file
# written at configure time) sets. configure_file touches OUTPUT only if its text changes.
include(${FACTS})
execute_process(COMMAND git -C ${SOURCE_DIR} rev-parse --verify HEAD
                OUTPUT_VARIABLE TRIGRAIN_COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE no_commit)
execute_process(COMMAND git -C ${SOURCE_DIR} status --porcelain --untracked-files=no
                OUTPUT_VARIABLE changes ERROR_QUIET RESULT_VARIABLE no_status)
if(no_commit)
  set(TRIGRAIN_COMMIT "")
endif()
if(changes OR no_commit OR no_status)
  set(TRIGRAIN_DIRTY true)
else()
  set(TRIGRAIN_DIRTY false)
endif()
configure_file(${TEMPLATE} ${OUTPUT} @ONLY)
