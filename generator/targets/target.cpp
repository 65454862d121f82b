#include "generator/targets/target.hpp"

#include "generator/targets/cpp.hpp"

namespace ocm::generate {
namespace {

std::string make_cpp(const spec::Model& model, const Options& options) {
  return header(model, options.spec_name);
}

constexpr Target table[] = {
    {"cpp", "C++20 header: structs, encoders and decoders, the catalogue", make_cpp},
    {"dbc", "CAN database, for canmatrix, cantools, SavvyCAN, BUSMASTER and the like", make_dbc},
    {"c", "C99 header: structs, encoders and decoders, requests; needs nothing else", make_c},
    {"markdown", "reference of topics, frames and fields, for people", make_markdown},
    {"wireshark", "dissector in Lua, for Wireshark and tshark", make_wireshark},
    {"json-schema", "JSON schema of the lines that `amiroctl listen --json` prints", make_json_schema},
};

}  // namespace

std::span<const Target> targets() noexcept {
  return table;
}

const Target* find_target(std::string_view name) noexcept {
  for (const Target& target : table)
    if (target.name == name) return &target;
  return nullptr;
}

std::string target_names() {
  std::string names;
  for (const Target& target : table) names += (names.empty() ? "" : ", ") + std::string{target.name};
  return names;
}

}  // namespace ocm::generate
