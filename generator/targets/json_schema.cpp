/// The JSON schema (draft 7) of a line of `amiroctl listen --json` or `decode --json`: one alternative a
/// frame or a message, one for requests, one for what could not be read; for the packets of J1939's transport
/// protocol one more. Bounds are what the width of a field holds, not its range: a part may say more than it
/// should.
#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <initializer_list>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "generator/targets/message_fields.hpp"
#include "generator/targets/target.hpp"
#include "generator/text/json.hpp"
#include "generator/text/messages.hpp"
#include "generator/text/words.hpp"

namespace ocm::generate {
namespace {

using spec::FieldModel;
using spec::MessageModel;
using spec::Model;

/// The nearest double, which is what a reader of the line makes of the same digits; a whole number of 64 bits
/// without a point.
Json number(base::Decimal decimal) {
  const std::string digits = print(decimal);
  std::int64_t whole = 0;
  const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), whole);
  if (read.ec == std::errc{} && read.ptr == digits.data() + digits.size()) return whole;
  return std::strtod(digits.c_str(), nullptr);
}

std::string identifier(std::uint16_t id) {
  base::Text<3> text;
  text.hex(id, 3);
  return std::string{text.view()};
}

Json schema_of(const FieldModel& field) {
  const auto width = field.position.width;
  Json schema{{"type", "number"}};
  if (field.number != protocol::Number::integer) {
    // JSON has no number for these.
    schema["type"] = std::array{"number", "string"};
    schema["pattern"] = "^(NaN|-?Infinity)$";
  } else if (width < 64) {
    auto low = exact_physical(field, protocol::lowest(width, field.is_signed));
    auto high = exact_physical(field, protocol::highest(width, field.is_signed));
    if (field.scale.digits < 0) std::swap(low, high);
    if (low) schema["minimum"] = number(*low);
    if (high) schema["maximum"] = number(*high);
  }
  if (!field.description.empty()) schema["description"] = field.description;
  return schema;
}

/// The name of a field's value. A value may have several; of flags all that are set have one.
Json names_of(const FieldModel& field) {
  if (field.flags) return {{"type", "string"}};
  std::map<std::int64_t, std::string> by_value;
  for (const auto& [name, raw] : field.values) {
    std::string& names = by_value[raw];
    names.append(names.empty() ? "" : "|").append(name);
  }
  std::set<std::string> all;
  for (const auto& [raw, names] : by_value) all.insert(names);
  return {{"enum", all}};
}

bool has_names(const std::vector<FieldModel>& fields) {
  return std::any_of(fields.begin(), fields.end(),
                     [](const FieldModel& field) { return !field.values.empty(); });
}

bool has_names(const Model& model) {
  for (const auto& message : model.messages)
    if (has_names(message.fields)) return true;
  for (const auto& topic : model.topics)
    for (const auto& frame : topic.frames)
      if (has_names(frame.fields)) return true;
  return false;
}

Json exactly(Json properties) {
  return {{"type", "object"}, {"properties", std::move(properties)}, {"additionalProperties", false}};
}

/// `names` of a frame or message: of those of its values that have one, or no such key.
void add_names(Json& properties, const std::vector<FieldModel>& fields, const Model& model) {
  if (!has_names(model)) return;  // then no line has the key
  Json names = Json::object();
  for (const FieldModel& field : fields)
    if (!field.values.empty()) names[field.name] = names_of(field);
  properties["names"] = has_names(fields) ? exactly(std::move(names)) : Json(false);
}

Json alternative(Json properties) {
  return {{"required", std::array{"priority", "topic", "frame", "fields", "units"}},
          {"not", {{"required", std::array{"error"}}}},
          {"properties", std::move(properties)}};
}

Json either(const Json& one, const Json& other) {
  Json any = Json::array();
  any.push_back(one);
  any.push_back(other);
  return {{"anyOf", any}};
}

Json any_of(std::initializer_list<const char*> keys) {
  Json any = Json::array();
  for (const char* const key : keys) any.push_back({{"required", std::array{key}}});
  return {{"anyOf", any}};
}

/// A selection of fields may leave some out.
Json sample(const Message& message, const Model& model) {
  Json fields = Json::object();
  Json units = Json::object();
  Json ids = Json::array();
  for (const FieldModel& field : message.frame->fields) {
    fields[field.name] = schema_of(field);
    units[field.name]["const"] = field.unit;
  }
  for (const spec::DerivedModel& derived : message.frame->derived)
    for (const std::string& name : {derived.name, derived.uncertainty_name()}) {
      fields[name] = {{"type", "number"}, {"minimum", 0}};
      units[name]["const"] = derived.unit;
    }
  for (const auto priority : priorities) ids.push_back(identifier(message.identifier(priority)));
  Json properties{
      {"id", {{"enum", ids}}},
      {"topic", {{"const", message.topic_name}}},
      {"frame", {{"const", message.frame_name.empty() ? message.topic_name : message.frame_name}}},
      {"fields", exactly(fields)},
      {"units", exactly(units)}};
  add_names(properties, message.frame->fields, model);
  return alternative(std::move(properties));
}

// --- plain messages ---

/// "0FEF1"
std::string group_text(const MessageModel& message) {
  base::Text<8> text;
  text.hex(group_of(message.address), 5);
  return std::string{text.view()};
}

/// What a message's fields can be. A selection may leave some out, a selector and a short message of J1939,
/// too.
Json contents(const MessageModel& message, const Model& model) {
  Json fields = Json::object();
  Json units = Json::object();
  for (const FieldModel& field : message.fields) {
    fields[field.name] = schema_of(field);
    units[field.name]["const"] = field.unit;
  }
  Json properties{
      {"topic", {{"const", message.name}}}, {"fields", exactly(fields)}, {"units", exactly(units)}};
  add_names(properties, message.fields, model);
  if (!message.description.empty()) properties["topic"]["description"] = message.description;
  if (message.is_j1939()) properties["pgn"]["const"] = group_text(message);
  return properties;
}

Json line_of(const MessageModel& message, const Model& model) {
  Json properties = contents(message, model);
  properties["frame"]["const"] = message.name;
  Json line;
  if (message.is_j1939()) {
    line["required"] =
        std::array{"priority", "pgn", "source", "destination", "topic", "frame", "fields", "units"};
    line["not"] = any_of({"error", "transport", "message"});
  } else {
    base::Text<8> id;
    id.hex(message.address.number, message.address.extended ? 8 : 3);
    properties["id"]["const"] = id.view();
    line["required"] = std::array{"topic", "frame", "fields", "units"};
    line["not"] = any_of({"error", "transport", "message", "priority", "pgn"});
  }
  line["properties"] = std::move(properties);
  return line;
}

bool has_groups(const Model& model) {
  return std::any_of(model.messages.begin(), model.messages.end(),
                     [](const MessageModel& message) { return message.is_j1939(); });
}

Json text_of(const char* pattern, const char* description) {
  return {{"type", "string"}, {"pattern", pattern}, {"description", description}};
}
Json number_of(int most, const char* description) {
  return {{"type", "integer"}, {"minimum", 0}, {"maximum", most}, {"description", description}};
}

void add_group_properties(Json& properties) {
  properties["pgn"] = text_of("^[0-9A-F]{5}$", "parameter group of J1939, hexadecimal");
  properties["source"] = number_of(255, "address of who sends it");
  properties["destination"] = number_of(255, "address of who it is for; 255: all");
}

/// What a packet of the transport protocol completes.
Json transported(const Model& model) {
  Json alternatives = Json::array();
  for (const MessageModel& message : model.messages) {
    if (!message.is_j1939()) continue;
    alternatives.push_back({{"required", std::array{"topic", "fields", "units"}},
                            {"not", any_of({"error"})},
                            {"properties", contents(message, model)}});
  }
  alternatives.push_back({{"required", std::array{"error"}}, {"not", any_of({"fields"})}});
  Json properties;
  properties["priority"] = number_of(7, "0 is the most urgent");
  add_group_properties(properties);
  properties["topic"]["type"] = "string";
  for (const char* const name : {"fields", "units"}) properties[name]["type"] = "object";
  if (has_names(model)) properties["names"]["type"] = "object";
  properties["error"]["type"] = "string";
  properties["data"] = text_of("^([0-9A-F]{2})*$", "the bytes");
  Json message = exactly(std::move(properties));
  message["required"] = std::array{"priority", "pgn", "source", "destination", "data"};
  message["oneOf"] = alternatives;
  message["description"] = "what this packet completes";
  return message;
}

// --- what is not of a frame ---

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
  const Json of_topics{{"enum", names}};
  const Json of_groups = number_of(7, "of J1939; 0 is the most urgent");
  const bool groups = has_groups(model);
  Json properties;
  properties["time_ns"] =
      text_of("^-?[0-9]+$", "Unix time in nanoseconds; a text, for it has more digits than a double");
  properties["bus"] = {{"type", "string"}, {"description", "the interface"}};
  properties["id"] = text_of("^([0-9A-F]{3}|[0-9A-F]{8})$", "identifier of 11 or of 29 bits, hexadecimal");
  if (!model.topics.empty() || groups)
    properties["priority"] = model.topics.empty() ? of_groups
                             : groups             ? either(of_topics, of_groups)
                                                  : of_topics;
  if (groups) add_group_properties(properties);
  properties["topic"] = {{"type", "string"}, {"description", "of " + model.robot}};
  properties["frame"] = {
      {"type", "string"},
      {"description",
       model.topics.empty() ? "the topic's name" : "within the topic; request; or the topic's name"}};
  properties["fields"] = {{"type", "object"}, {"description", "physical values"}};
  properties["units"] = {{"type", "object"}, {"description", "of the fields; empty for counts"}};
  if (has_names(model))
    properties["names"] = {{"type", "object"}, {"description", "of those values that have one"}};
  properties["error"] = {{"type", "string"}, {"description", "why there are no fields"}};
  if (groups) {
    properties["transport"] = {{"enum", std::array{"control", "packet"}},
                               {"description", "of J1939's transport protocol"}};
    properties["message"] = transported(model);
  }
  properties["data"] =
      text_of("^(([0-9A-F]{2}){0,64}|R[0-9]*)$", "the bytes; R and the length of a remote frame");
  properties["direction"] = {{"enum", std::array{"received", "sent"}}};
  properties["fd"] = exactly({{"brs", {{"type", "boolean"}}}, {"esi", {{"type", "boolean"}}}});
  properties["raw_dlc"] = {{"type", "integer"}, {"minimum", 9}, {"maximum", 15}};
  return properties;
}

}  // namespace

std::string make_json_schema(const Model& model, const Options& options) {
  Json alternatives = Json::array();
  for (const Message& message : messages(model)) alternatives.push_back(sample(message, model));
  if (!model.topics.empty()) alternatives.push_back(request(model));
  for (const MessageModel& message : model.messages) alternatives.push_back(line_of(message, model));
  alternatives.push_back({{"required", std::array{"error"}}, {"not", {{"required", std::array{"fields"}}}}});
  if (has_groups(model))
    alternatives.push_back({{"required", std::array{"priority", "pgn", "source", "destination", "transport"}},
                            {"not", any_of({"error", "fields", "topic"})}});
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
