# {fmt} for another processor, of the same headers. Its one source, which Debian does not bring, is fmt.cpp here: header-only,
# every file of the tool would compile it for itself, which makes a third of the time that the tool takes.
file(STRINGS ${ocm_header_only}/fmt/core.h version REGEX "^#define FMT_VERSION [0-9]+")
if(version MATCHES "FMT_VERSION 9[0-9][0-9][0-9][0-9]$")
  ocm_header_only_package(NAME fmt TARGET fmt::fmt HEADER fmt/format.h)
  if(NOT TARGET ocm_fmt)
    add_library(ocm_fmt STATIC ${CMAKE_CURRENT_LIST_DIR}/fmt.cpp)
    target_include_directories(ocm_fmt SYSTEM PRIVATE ${ocm_header_only})
    target_compile_features(ocm_fmt PRIVATE cxx_std_20)
  endif()
  set_property(TARGET fmt::fmt PROPERTY INTERFACE_LINK_LIBRARIES ocm_fmt)
else()  # what fmt.cpp lists is that of version 9
  ocm_header_only_package(NAME fmt TARGET fmt::fmt HEADER fmt/format.h DEFINES FMT_HEADER_ONLY)
endif()
