# An 8-bit AVR in C++20: Debian's avr-gcc is GCC 5, which stops at C++14, so clang compiles, and avr-gcc links, with its
# start-up code, libgcc and avr-libc. Standard headers are those of arm-none-eabi's libstdc++ and newlib, of which only
# what needs no library is of use here: array, bit, chrono's durations, concepts, optional, span, string_view.
#
#   cmake -S firmware/avr -B build/avr --toolchain cmake/toolchains/avr.cmake
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR avr)
find_program(CMAKE_CXX_COMPILER NAMES clang++-14 REQUIRED)
set(CMAKE_CXX_COMPILER_TARGET avr)
find_program(OCM_AVR_GCC avr-gcc REQUIRED)
find_program(CMAKE_SIZE avr-size)
set(CMAKE_CXX_LINK_EXECUTABLE "${OCM_AVR_GCC} <LINK_FLAGS> <OBJECTS> -o <TARGET> <LINK_LIBRARIES>")

set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)  # there is no program to link before an image names its chip
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
