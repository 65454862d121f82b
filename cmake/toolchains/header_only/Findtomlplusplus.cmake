ocm_header_only_package(NAME tomlplusplus TARGET tomlplusplus::tomlplusplus HEADER toml++/toml.h)
