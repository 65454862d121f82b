# Builds the images: cmake -D SOURCE=firmware -D BINARY=folder [-D TOOLCHAIN=file] -P build.cmake
if(NOT TOOLCHAIN)
  set(TOOLCHAIN ${SOURCE}/../cmake/toolchains/arm-none-eabi.cmake)
endif()
if(NOT EXISTS ${BINARY}/build.ninja OR NOT EXISTS ${BINARY}/CMakeCache.txt)
  file(REMOVE_RECURSE ${BINARY})
  execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE} -B ${BINARY} -G Ninja
                          --toolchain ${TOOLCHAIN}
                  COMMAND_ERROR_IS_FATAL ANY)
endif()
# On all processors, but behind the tests that tell time beside it.
cmake_host_system_information(RESULT jobs QUERY NUMBER_OF_LOGICAL_CORES)
execute_process(COMMAND nice -n 10 ${CMAKE_COMMAND} --build ${BINARY} --parallel ${jobs} COMMAND_ERROR_IS_FATAL ANY)
