/// The JSON schema (draft 7) of a line of `amiroctl listen --json`: one alternative a frame, one for
/// requests, one for what could not be read. Bounds are what the width of a field holds, not its range: a
/// part may say more than it should.
#include <array>
#include <cstdlib>
#include <string>
#include <utility>

#include "generator/targets/target.hpp"
#include "generator/text/json.hpp"
#include "generator/text/messages.hpp"
#include "generator/text/words.hpp"

namespace ocm::generate {
namespace {

using spec::FieldModel;
using spec::Model;

/// The nearest double, which is what a reader of the line makes of the same digits; a whole number without a
/// point.
Json number(base::Decimal decimal) {
  const std::string digits = print(decimal);
  if (digits.find_first_not_of("-0123456789") == std::string::npos)
    return std::strtoll(digits.c_str(), nullptr, 10);
  return std::strtod(digits.c_str(), nullptr);
}

std::string identifier(std::uint16_t id) {
  base::Text<3> text;
  text.hex(id, 3);
  return std::string{text.view()};
}

Json schema_of(const FieldModel& field) {
  const auto width = field.position.width;
  auto low = number(physical(field, protocol::lowest(width, field.is_signed)));
  auto high = number(physical(field, protocol::highest(width, field.is_signed)));
  if (field.scale.digits < 0) std::swap(low, high);
  Json schema{{"type", "number"}, {"minimum", low}, {"maximum", high}};
  if (!field.description.empty()) schema["description"] = field.description;
  return schema;
}

Json exactly(Json properties) {
  return {{"type", "object"}, {"properties", std::move(properties)}, {"additionalProperties", false}};
}

Json alternative(Json properties) {
  return {{"required", std::array{"priority", "topic", "frame", "fields", "units"}},
          {"not", {{"required", std::array{"error"}}}},
          {"properties", std::move(properties)}};
}

/// A selection of fields may leave some out.
Json sample(const Message& message) {
  Json fields = Json::object();
  Json units = Json::object();
  Json ids = Json::array();
  for (const FieldModel& field : message.frame->fields) {
    fields[field.name] = schema_of(field);
    units[field.name]["const"] = field.unit;
  }
  for (const auto priority : priorities) ids.push_back(identifier(message.identifier(priority)));
  return alternative(
      {{"id", {{"enum", ids}}},
       {"topic", {{"const", message.topic_name}}},
       {"frame", {{"const", message.frame_name.empty() ? message.topic_name : message.frame_name}}},
       {"fields", exactly(fields)},
       {"units", exactly(units)}});
}

Json request(const Model& model) {
  Json sensors = Json::array();
  Json ids = Json::array();
  for (const auto& topic : model.topics) {
    if (topic.kind != protocol::Kind::sensor) continue;
    sensors.push_back(topic.name);
    for (const auto priority : priorities) ids.push_back(identifier(request_identifier(topic, priority)));
  }
  Json modes = Json::array();
  for (const auto mode : mode_names) modes.push_back(mode);
  auto fields = exactly({{"mode", {{"enum", modes}}},
                         {"period", {{"type", "number"}, {"exclusiveMinimum", 0}, {"maximum", 65535}}}});
  fields["required"] = std::array{"mode"};
  return alternative({{"id", {{"enum", ids}}},
                      {"topic", {{"enum", sensors}}},
                      {"frame", {{"const", "request"}}},
                      {"fields", fields},
                      {"units", exactly({{"period", {{"const", "s"}}}})}});
}

Json common_properties(const Model& model) {
  Json names = Json::array();
  for (const auto priority : priorities) names.push_back(protocol::name(priority));
  const auto text = [](const char* pattern, const char* description) {
    return Json{{"type", "string"}, {"pattern", pattern}, {"description", description}};
  };
  Json properties;
  properties["time_ns"] =
      text("^-?[0-9]+$", "Unix time in nanoseconds; a text, for it has more digits than a double");
  properties["bus"] = {{"type", "string"}, {"description", "the interface"}};
  properties["id"] = text("^([0-9A-F]{3}|[0-9A-F]{8})$", "identifier of 11 or of 29 bits, hexadecimal");
  properties["priority"] = {{"enum", names}};
  properties["topic"] = {{"type", "string"}, {"description", "of " + model.robot}};
  properties["frame"] = {{"type", "string"},
                         {"description", "within the topic; request; or the topic's name"}};
  properties["fields"] = {{"type", "object"}, {"description", "physical values"}};
  properties["units"] = {{"type", "object"}, {"description", "of the fields; empty for counts"}};
  properties["error"] = {{"type", "string"}, {"description", "why there are no fields"}};
  properties["data"] =
      text("^(([0-9A-F]{2}){0,64}|R[0-9]*)$", "the bytes; R and the length of a remote frame");
  properties["direction"] = {{"enum", std::array{"received", "sent"}}};
  properties["fd"] = exactly({{"brs", {{"type", "boolean"}}}, {"esi", {{"type", "boolean"}}}});
  properties["raw_dlc"] = {{"type", "integer"}, {"minimum", 9}, {"maximum", 15}};
  return properties;
}

}  // namespace

std::string make_json_schema(const Model& model, const Options& options) {
  Json alternatives = Json::array();
  for (const Message& message : messages(model)) alternatives.push_back(sample(message));
  alternatives.push_back(request(model));
  alternatives.push_back({{"required", std::array{"error"}}, {"not", {{"required", std::array{"fields"}}}}});
  Json schema;
  schema["$schema"] = "http://json-schema.org/draft-07/schema#";
  schema["$comment"] = "Made by ocm-generate from " + options.spec_name +
                       ". Do not edit: change the spec, and generate again.";
  schema["title"] = "A line of amiroctl listen --json, of " + model.robot;
  schema["type"] = "object";
  schema["required"] = std::array{"time_ns", "bus", "id", "data"};
  schema["properties"] = common_properties(model);
  schema["additionalProperties"] = false;
  schema["oneOf"] = alternatives;
  return schema.lines();
}

}  // namespace ocm::generate
