ocm_header_only_package(NAME CLI11 TARGET CLI11::CLI11 HEADER CLI/CLI.hpp)
