# ocm_rooms(TARGET ROOM... [ALONE FILE...] [EXCEPT FILE...]): adds to TARGET the sources of each folder, compiled as one
# file a folder; folders joined by a '+' are compiled as one together, for what several small rooms include is then compiled
# once. Those behind ALONE are compiled one by one, those behind EXCEPT are not of the target. OCM_UNITY=OFF compiles each
# file by itself.
option(OCM_UNITY "Compile each room of the tools at once, and several tests of a floor" ON)

function(ocm_rooms target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "ALONE;EXCEPT")
  foreach(rooms IN LISTS arg_UNPARSED_ARGUMENTS)
    string(REPLACE "+" ";" folders ${rooms})
    string(REPLACE "+" "_" group ${rooms})
    list(TRANSFORM folders REPLACE "(.+)" "${CMAKE_CURRENT_SOURCE_DIR}/\\1/*.cpp")
    file(GLOB sources CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} ${folders})
    list(REMOVE_ITEM sources "" ${arg_EXCEPT})
    target_sources(${target} PRIVATE ${sources})
    list(REMOVE_ITEM sources "" ${arg_ALONE})
    set_source_files_properties(${sources} PROPERTIES UNITY_GROUP ${group})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${OCM_UNITY} UNITY_BUILD_MODE GROUP)
endfunction()

# ocm_compile_quickly(TARGET...): -O1 in place of Release's -O3, for what does its work once a command rather than once a
# frame: it halves the time to compile. docs/decisions/0021 has the figures.
function(ocm_compile_quickly)
  foreach(target IN LISTS ARGN)
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  endforeach()
endfunction()

# ocm_parse_once(TARGET...): reads what nearly every file of the tools includes, cmake/precompiled.hpp, once for all of
# them. A file still includes what it uses. Without {fmt}, as where a board's build needs ocm-generate, each reads it for itself.
find_package(fmt QUIET)
include(${CMAKE_CURRENT_LIST_DIR}/OcmPrecompiled.cmake)
function(ocm_parse_once)
  if(fmt_FOUND)
    foreach(target IN LISTS ARGN)
      target_precompile_headers(${target} REUSE_FROM ocm_tool_header)
      target_compile_options(${target} PRIVATE ${OCM_PRECOMPILED_OPTIONS})
      target_link_libraries(${target} PRIVATE fmt::fmt)
    endforeach()
  endif()
endfunction()

# ocm_compile_for_speed(TARGET...): for what works at every frame. GCC stops inlining when a file has grown by two fifths, which a
# room that is compiled at once soon has, and then calls a function for every pair of digits. The limit of a precompiled header
# would count in place of the one that is given here, so that there is none.
function(ocm_compile_for_speed)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU" OR CMAKE_CROSSCOMPILING)
    ocm_parse_once(${ARGN})
    return()
  endif()
  foreach(target IN LISTS ARGN)
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:--param=inline-unit-growth=500>)
  endforeach()
endfunction()

# The owner of the precompiled header, which CMake makes only beside something to compile. All that use it have its options.
if(fmt_FOUND)
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/precompiled.cpp CONTENT "")
  add_library(ocm_tool_header OBJECT ${PROJECT_BINARY_DIR}/precompiled.cpp)
  target_link_libraries(ocm_tool_header PRIVATE ocm ocm_strict fmt::fmt)
  target_compile_options(ocm_tool_header PRIVATE ${OCM_TOOL_OPTIONS} ${OCM_PRECOMPILED_OPTIONS})
  ocm_precompile(ocm_tool_header ${CMAKE_CURRENT_LIST_DIR}/precompiled.hpp)
endif()
