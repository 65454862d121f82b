# Builds for another machine, in a folder of its own:
#   cmake -D SOURCE=folder -D BINARY=folder -D TOOLCHAIN=file [-D TARGETS=a;b] [-D OPTIONS=-Dx=y;...] -P build.cmake

# scripts/build, in the same folder at the same time, waits; so does this (scripts/turns.bash).
if(NOT ALONE)
  file(MAKE_DIRECTORY ${BINARY})
  execute_process(COMMAND flock ${BINARY}/.lock ${CMAKE_COMMAND} -D ALONE=ON -D SOURCE=${SOURCE} -D BINARY=${BINARY}
                  -D TOOLCHAIN=${TOOLCHAIN} "-DTARGETS=${TARGETS}" "-DOPTIONS=${OPTIONS}" -P ${CMAKE_CURRENT_LIST_FILE}
                  COMMAND_ERROR_IS_FATAL ANY)
  return()
endif()
if(NOT EXISTS ${BINARY}/build.ninja OR NOT EXISTS ${BINARY}/CMakeCache.txt)
  file(REMOVE_RECURSE ${BINARY}/CMakeCache.txt ${BINARY}/CMakeFiles)
endif()
execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE} -B ${BINARY} -G Ninja --toolchain ${TOOLCHAIN} ${OPTIONS}
                COMMAND_ERROR_IS_FATAL ANY)
if(NOT TARGETS)
  set(TARGETS all)
endif()
# On all processors, but behind the tests that tell time beside it.
cmake_host_system_information(RESULT jobs QUERY NUMBER_OF_LOGICAL_CORES)
execute_process(COMMAND nice -n 10 ${CMAKE_COMMAND} --build ${BINARY} --parallel ${jobs} --target ${TARGETS} COMMAND_ERROR_IS_FATAL ANY)
