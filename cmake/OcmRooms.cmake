# ocm_rooms(TARGET ROOM... [ALONE FILE...] [EXCEPT FILE...]): adds to TARGET the sources of each folder, compiled as one
# file a folder. Those behind ALONE are compiled one by one, those behind EXCEPT are not of the target. OCM_UNITY=OFF
# compiles each file by itself.
option(OCM_UNITY "Compile each room of the tools at once" ON)

function(ocm_rooms target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "ALONE;EXCEPT")
  foreach(room IN LISTS arg_UNPARSED_ARGUMENTS)
    file(GLOB sources CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR}/${room}/*.cpp)
    list(REMOVE_ITEM sources "" ${arg_EXCEPT})
    target_sources(${target} PRIVATE ${sources})
    list(REMOVE_ITEM sources "" ${arg_ALONE})
    set_source_files_properties(${sources} PROPERTIES UNITY_GROUP ${room})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${OCM_UNITY} UNITY_BUILD_MODE GROUP)
endfunction()
