# A folder that holds the header-only libraries of the machine that builds, and nothing else of its /usr/include, whose
# other headers are of another processor.
set(ocm_header_only ${CMAKE_BINARY_DIR}/header_only)
include(${CMAKE_CURRENT_LIST_DIR}/../../OcmCache.cmake)
foreach(library CLI catch2 fmt nlohmann toml++ valijson)
  foreach(include /usr/include ${OCM_CACHE}/${library}/usr/include)
    if(NOT EXISTS ${ocm_header_only}/${library} AND EXISTS ${include}/${library})
      file(MAKE_DIRECTORY ${ocm_header_only})
      file(CREATE_LINK ${include}/${library} ${ocm_header_only}/${library} SYMBOLIC)
    endif()
  endforeach()
endforeach()

# ocm_header_only_package(NAME name TARGET target HEADER header [DEFINES ...]): what a find module of these says.
macro(ocm_header_only_package)
  cmake_parse_arguments(arg "" "NAME;TARGET;HEADER" "DEFINES" ${ARGN})
  if(EXISTS ${ocm_header_only}/${arg_HEADER})
    if(NOT TARGET ${arg_TARGET})
      add_library(${arg_TARGET} INTERFACE IMPORTED)
      set_target_properties(${arg_TARGET} PROPERTIES INTERFACE_INCLUDE_DIRECTORIES ${ocm_header_only}
                            INTERFACE_COMPILE_DEFINITIONS "${arg_DEFINES}")
    endif()
    set(${arg_NAME}_FOUND TRUE)
  elseif(${arg_NAME}_FIND_REQUIRED)
    message(FATAL_ERROR "There is no /usr/include/${arg_HEADER}: run scripts/setup")
  endif()
endmacro()
