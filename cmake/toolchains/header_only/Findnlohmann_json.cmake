ocm_header_only_package(NAME nlohmann_json TARGET nlohmann_json::nlohmann_json HEADER nlohmann/json.hpp)
