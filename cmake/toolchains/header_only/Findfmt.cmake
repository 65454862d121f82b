ocm_header_only_package(NAME fmt TARGET fmt::fmt HEADER fmt/format.h DEFINES FMT_HEADER_ONLY)
