// valijson is slow to compile: it has this file to itself.
#include "generator/spec/schema.hpp"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include "generator/spec/reader.hpp"
#include "generator/spec/spec.hpp"

namespace ocm::spec {

namespace {

nlohmann::json to_json(const Node& node) {
  switch (node.kind) {
    case Node::Kind::null:
      return nullptr;
    case Node::Kind::boolean:
      return node.truth;
    case Node::Kind::string:
      return node.text;
    case Node::Kind::number:
      // The digits came out of the same parser, so they go in again.
      return nlohmann::json::parse(node.text, nullptr, false);
    case Node::Kind::array: {
      auto list = nlohmann::json::array();
      for (const Node& item : node.items) list.push_back(to_json(item));
      return list;
    }
    case Node::Kind::object: {
      auto object = nlohmann::json::object();
      for (const auto& [name, member] : node.members) object[name] = to_json(member);
      return object;
    }
  }
  return nullptr;
}

/// The place that valijson names by "<root>", "[topics]", "[3]", ... as a node, its JSON pointer, and what
/// the schema says of it.
struct Place {
  const Node* node;
  std::string path;
  const nlohmann::json* schema;
};

const nlohmann::json* resolved(const nlohmann::json& root, const nlohmann::json* schema) {
  while (schema != nullptr && schema->is_object() && schema->contains("$ref"))
    schema = &root.at(nlohmann::json::json_pointer{schema->at("$ref").get<std::string>().substr(1)});
  return schema;
}

Place find_place(const Node& root, const nlohmann::json& schema, const std::vector<std::string>& context) {
  Place place{&root, "", &schema};
  for (const std::string& step : context) {
    if (step.size() < 2 || step.front() != '[') continue;
    const std::string key = step.substr(1, step.size() - 2);
    const Node* next = nullptr;
    const nlohmann::json* rule = resolved(schema, place.schema);
    const char* rules = place.node->is(Node::Kind::array) ? "items" : "properties";
    rule = rule != nullptr && rule->contains(rules) ? &rule->at(rules) : nullptr;
    if (place.node->is(Node::Kind::array)) {
      const std::size_t index = std::stoul(key);
      if (index < place.node->items.size()) next = &place.node->items[index];
    } else {
      next = place.node->find(key);
      rule = rule != nullptr && rule->contains(key) ? &rule->at(key) : nullptr;
    }
    if (next == nullptr) break;
    place = {next, place.path + "/" + pointer_step(key), rule};
  }
  place.schema = resolved(schema, place.schema);
  return place;
}

bool is_at_or_below(const std::string& place, const std::string& path) {
  const auto at = place.find(": ");
  if (at == std::string::npos) return false;
  const std::string_view told = std::string_view{place}.substr(at + 2);
  return told.substr(0, path.size()) == path &&
         (told.size() == path.size() || path.empty() || told[path.size()] == '/');
}

}  // namespace

struct Schema::Parsed {
  nlohmann::json json;
  valijson::Schema rules;
  valijson::Validator validator;  ///< keeps the regular expressions that it has compiled
};

Schema::Schema(std::string_view text, const Document& document) : document_(document), parsed_(new Parsed) {
  parsed_->json = nlohmann::json::parse(text);
  valijson::SchemaParser{}.populateSchema(valijson::adapters::NlohmannJsonAdapter{parsed_->json},
                                          parsed_->rules);
}

void Schema::validate(const Node& root, std::string_view file_name, std::vector<Problem>& problems) const {
  const auto document = to_json(root);
  valijson::ValidationResults results;
  if (parsed_->validator.validate(parsed_->rules, valijson::adapters::NlohmannJsonAdapter{document},
                                  &results))
    return;

  // Innermost first: what surrounds a bad value is reported by valijson as well, and says nothing new.
  std::vector<Problem> found;
  valijson::ValidationResults::Error error;
  while (results.popError(error)) {
    const Place place = find_place(root, parsed_->json, error.context);
    const auto told_below = [&](const Problem& p) { return is_at_or_below(p.place, place.path); };
    if (std::any_of(problems.begin(), problems.end(), told_below) ||
        std::any_of(found.begin(), found.end(), told_below))
      continue;
    const bool described =
        place.schema != nullptr && place.schema->is_object() && place.schema->contains("description");
    found.push_back({std::string{file_name} + ":" + std::to_string(place.node->line) + ": " +
                         (place.path.empty() ? "/" : place.path),
                     error.description,
                     described ? place.schema->at("description").get<std::string>()
                               : "see " + std::string{document_.schema}});
  }
  problems.insert(problems.end(), found.begin(), found.end());
}

void validate_by_schema(const Node& root, std::string_view file_name, std::vector<Problem>& problems) {
  static const Schema schema{schema_text(), {}};  // read once: it takes longer than the validation of a spec
  schema.validate(root, file_name, problems);
}

}  // namespace ocm::spec
