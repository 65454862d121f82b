# Runs a program that must fail, and must say why: cmake -D RUN="program argument..." -D WORDS=regex -P must_fail.cmake
separate_arguments(run UNIX_COMMAND "${RUN}")
execute_process(COMMAND ${run} RESULT_VARIABLE code OUTPUT_VARIABLE said ERROR_VARIABLE said TIMEOUT 60)
if(code STREQUAL 0)
  message(FATAL_ERROR "It passed, and must not. It said: ${said}")
elseif(NOT said MATCHES "${WORDS}")
  message(FATAL_ERROR "It ended with ${code}, but did not say '${WORDS}'. It said: ${said}")
endif()
