# What has been compiled once is not compiled again, where ccache is there and may write to its folder.
find_program(OCM_CCACHE ccache)
if(NOT OCM_CCACHE OR DEFINED CMAKE_CXX_COMPILER_LAUNCHER)
  return()
endif()
# A user without a home has no folder for it, and every compiler would fail.
execute_process(COMMAND ${OCM_CCACHE} --get-config=cache_dir OUTPUT_VARIABLE cache OUTPUT_STRIP_TRAILING_WHITESPACE)
execute_process(COMMAND ${CMAKE_COMMAND} -E make_directory "${cache}" RESULT_VARIABLE no_cache ERROR_QUIET)
execute_process(COMMAND test -w "${cache}" RESULT_VARIABLE not_writable)
if(no_cache OR not_writable)
  message(STATUS "ccache may not write to ${cache}: nothing is cached; CCACHE_DIR names another folder")
  return()
endif()
# It caches what uses a precompiled header when it is allowed to, and remembers the digest of a file by its inode: that of
# a precompiled header, 80 MB, takes 0.4 s of each compilation otherwise.
set(CMAKE_CXX_COMPILER_LAUNCHER env CCACHE_SLOPPINESS=pch_defines,time_macros CCACHE_INODECACHE=1 ${OCM_CCACHE})
