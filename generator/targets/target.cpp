#include "generator/targets/target.hpp"

#include "generator/targets/cpp.hpp"
#include "generator/targets/dbc_messages.hpp"

namespace ocm::generate {
namespace {

std::string make_cpp(const spec::Model& model, const Options& options) {
  return header(model, options.spec_name);
}

constexpr Target table[] = {
    {"cpp", "C++20 header: structs, encoders and decoders, the catalogue", make_cpp, true, true},
    {"spec", "our JSON of plain messages, from a DBC file", make_spec, false, true},
    {"dbc", "CAN database, for canmatrix, cantools, SavvyCAN, BUSMASTER and the like", make_dbc, true, true},
    {"c", "C99 header: structs, encoders and decoders, requests; needs nothing else", make_c, true, true},
    {"markdown", "reference of topics, messages and fields, for people", make_markdown, true, true},
    {"wireshark", "dissector in Lua, for Wireshark and tshark", make_wireshark, true, true},
    {"json-schema", "JSON schema of the lines that `amiroctl listen --json` prints", make_json_schema, true,
     true},
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

bool has_any(const Target& target, const spec::Model& model) noexcept {
  return (target.of_topics && !model.topics.empty()) || (target.of_messages && !model.messages.empty());
}

std::vector<std::string> left_out(const Target& target, const spec::Model& model) {
  std::vector<std::string> out;
  const auto all = [&](std::size_t count, const char* what) {
    if (count != 0) out.push_back("all " + std::to_string(count) + " " + what);
  };
  if (!target.of_topics) all(model.topics.size(), "topics");
  if (!target.of_messages) all(model.messages.size(), "messages");
  if (target.make == make_dbc || target.make == make_spec)
    for (const auto& [what, count] : model.not_kept) out.push_back(std::to_string(count) + " " + what);
  if (target.make == make_dbc)
    for (std::string& each : lost_in_dbc(model)) out.push_back(std::move(each));
  return out;
}

std::string message_target_names() {
  std::string names;
  for (const Target& target : table)
    if (target.of_messages) names += (names.empty() ? "" : ", ") + std::string{target.name};
  return names;
}

std::string target_names() {
  std::string names;
  for (const Target& target : table) names += (names.empty() ? "" : ", ") + std::string{target.name};
  return names;
}

}  // namespace ocm::generate
