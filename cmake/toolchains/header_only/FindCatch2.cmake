ocm_header_only_package(NAME Catch2 TARGET Catch2::Catch2 HEADER catch2/catch.hpp)
