# No build system at all: a copy of include/, and one command.
file(REMOVE_RECURSE ${SCRATCH})
file(COPY ${INCLUDE}/ocm DESTINATION ${SCRATCH})
set(sources ${CMAKE_CURRENT_LIST_DIR}/../consumer.cpp ${CMAKE_CURRENT_LIST_DIR}/../host.cpp)
execute_process(COMMAND ${CXX} -std=c++20 -I ${SCRATCH} ${sources} -o ${SCRATCH}/consumer COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${SCRATCH}/consumer COMMAND_ERROR_IS_FATAL ANY)
