# The operator's board, a Cortex-A8 with Linux, by Debian's g++-arm-linux-gnueabihf: small static programs, which ask
# for nothing but the kernel. What amiroctl needs besides is header-only here, and taken from the machine that builds.
#
#   cmake -S . -B build/operator -G Ninja --toolchain cmake/toolchains/cortex-a8.cmake      (scripts/build operator)
#
# ctest runs what it builds by qemu-arm-static.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR armv7-a)
set(CMAKE_CXX_COMPILER arm-linux-gnueabihf-g++)
find_program(qemu_arm qemu-arm-static)
set(CMAKE_CROSSCOMPILING_EMULATOR ${qemu_arm} -cpu cortex-a8)

# Logs are larger than 2 GiB: _FILE_OFFSET_BITS.
set(CMAKE_CXX_FLAGS_INIT "-mcpu=cortex-a8 -mfpu=neon -mfloat-abi=hard -ffunction-sections -fdata-sections -D_FILE_OFFSET_BITS=64")
set(CMAKE_EXE_LINKER_FLAGS_INIT "-static -Wl,--gc-sections")
# Optimised for size: MinSizeRel, the default here, is half of Release. The tool as a whole (-flto) and equal functions once
# (gold's --icf) are 6 % less; optimisations of loops that make code larger, left out, another 1.4 %; the whole tool at once, not in
# partitions, 0.5 %, and texts that end as others do once (gold's -O2), 0.4 %. The tests of the library are compiled without all that.
set(CMAKE_BUILD_TYPE MinSizeRel CACHE STRING "Optimised for size")
set(CMAKE_CXX_FLAGS_MINSIZEREL_INIT "-Os -DNDEBUG")
set(CMAKE_EXE_LINKER_FLAGS_MINSIZEREL_INIT "-s -flto=auto -flto-partition=one -fuse-ld=gold -Wl,--icf=safe -Wl,-O2")
set(OCM_TOOL_OPTIONS -flto=auto -fno-ivopts -fno-gcse -fno-move-loop-invariants CACHE STRING "What the tool alone is compiled with")

set(CMAKE_FIND_ROOT_PATH /usr/arm-linux-gnueabihf)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
list(APPEND CMAKE_MODULE_PATH ${CMAKE_CURRENT_LIST_DIR}/header_only)
include(${CMAKE_CURRENT_LIST_DIR}/header_only/folder.cmake)
set(OCM_VALIJSON_INCLUDE_DIR ${ocm_header_only} CACHE PATH "")
