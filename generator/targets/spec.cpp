/// Our own JSON of a bus's messages: what a DBC file says becomes a spec that people can go on with. Read
/// again, it is the same.
#include <cstddef>
#include <cstdio>
#include <set>
#include <string>
#include <vector>

#include "generator/targets/numbers.hpp"
#include "generator/targets/target.hpp"
#include "generator/text/json.hpp"
#include "generator/text/words.hpp"

namespace ocm::generate {
namespace {

using protocol::ByteOrder;
using spec::AttributeModel;
using spec::FieldModel;
using spec::MessageModel;
using spec::Model;
using spec::Source;

std::string json(std::string_view text) {
  return Json{text}.line();
}

/// An object's members, the values as JSON.
class Members {
 public:
  void add(std::string_view name, const std::string& value) {
    text_ += text_.empty() ? "" : ", ";
    text_ += json(name) + ": " + value;
  }
  void add_text(std::string_view name, std::string_view text) {
    if (!text.empty()) add(name, json(text));
  }
  void add_names(std::string_view name, const std::vector<std::string>& names) {
    if (names.empty()) return;
    std::string list;
    for (const std::string& each : names) list += (list.empty() ? "" : ", ") + json(each);
    add(name, "[" + list + "]");
  }
  void add_time(std::string_view name, base::Duration time) {
    if (time.count() != 0) add(name, json(print(base::normalised(time.count(), -6)) + "ms"));
  }
  void add_attributes(const std::vector<AttributeModel>& attributes) {
    if (attributes.empty()) return;
    Members list;
    for (const AttributeModel& attribute : attributes) list.add(attribute.name, json(attribute.text));
    add("attributes", list.object());
  }
  void add_source(const Source& source) {
    if (source.particular.empty()) return add_text("source", source.general);
    Members facts;
    facts.add_text("default", source.general);
    for (const auto& [fact, text] : source.particular) facts.add_text(fact, text);
    add("source", facts.object());
  }

  [[nodiscard]] const std::string& text() const noexcept { return text_; }
  [[nodiscard]] std::string object() const { return text_.empty() ? "{}" : "{ " + text_ + " }"; }

 private:
  std::string text_;
};

bool is_one(base::Decimal number) {
  return base::compare(number, {1, 0}) == 0;
}

void add_place(Members& out, protocol::Position at, ByteOrder usual) {
  const unsigned first = at.order == ByteOrder::little ? 0 : 7;  // the bit of a byte where a whole one begins
  if (at.start % 8 == first)
    out.add("byte", std::to_string(at.start / 8));
  else
    out.add("bit", std::to_string(at.start));
  if (at.order != usual) out.add_text("byte_order", at.order == ByteOrder::little ? "little" : "big");
}

std::string type_of(const FieldModel& field) {
  const char* kind = field.number != protocol::Number::integer ? "f" : field.is_signed ? "i" : "u";
  return kind + std::to_string(field.position.width);
}

void add_values(Members& out, const FieldModel& field) {
  if (field.values.empty()) return;
  std::set<std::string_view> names;
  for (const auto& value : field.values) names.insert(value.name);
  if (names.size() == field.values.size()) {
    Members list;
    for (const auto& value : field.values) list.add(value.name, field.raw_text(value.raw));
    return out.add(field.flags ? "flags" : "values", list.object());
  }
  std::string list;
  for (const auto& value : field.values) {
    Members each;
    each.add("raw", field.raw_text(value.raw));
    each.add("name", json(value.name));
    list += (list.empty() ? "" : ", ") + each.object();
  }
  out.add("values", "[" + list + "]");
}

std::string field_of(const FieldModel& field, ByteOrder usual) {
  Members out;
  out.add_text("name", field.name);
  add_place(out, field.position, usual);
  out.add_text("type", type_of(field));
  if (!is_one(field.scale)) out.add("scale", print(field.scale));
  if (field.offset.digits != 0) out.add("offset", print(field.offset));
  out.add_text("unit", field.unit);
  if (field.range) out.add("range", "[" + print(field.range->min) + ", " + print(field.range->max) + "]");
  add_values(out, field);
  out.add_text("selector", field.selector);
  std::string selected;
  for (const auto& [first, last] : field.selected) {
    selected += selected.empty() ? "" : ", ";
    selected += first == last ? std::to_string(first)
                              : "[" + std::to_string(first) + ", " + std::to_string(last) + "]";
  }
  if (!selected.empty()) out.add("selected", "[" + selected + "]");
  if (field.start) out.add("start", start_text(field));
  out.add_names("receivers", field.receivers);
  out.add_text("description", field.description);
  out.add_attributes(field.attributes);
  out.add_source(field.source);
  return out.object();
}

/// "\"0x0C8\"", as wide as such identifiers are.
std::string identifier(const MessageModel& message) {
  char text[16];
  std::snprintf(text, sizeof text, message.address.extended ? "\"0x%08X\"" : "\"0x%03X\"",
                message.address.number);
  return text;
}

std::string message_of(const Model& model, const MessageModel& message, ByteOrder usual) {
  Members head;
  head.add_text("name", message.name);
  head.add_names("alias", message.aliases);
  head.add("id", identifier(message));
  if (message.address.extended) head.add_text("format", message.is_j1939() ? "j1939" : "extended");
  head.add("length", std::to_string(message.length));
  if (message.fd != (message.length > 8 && !message.is_j1939()))
    head.add("fd", message.fd ? "true" : "false");
  if (message.board < model.boards.size()) head.add_text("sender", model.boards[message.board].name);
  head.add_names("other_senders", message.other_senders);
  head.add_time("period", message.period);
  head.add_time("shortest_period", message.shortest_period);
  head.add_time("deadline", message.deadline);
  head.add_time("jitter", message.jitter);
  head.add_text("send_type", message.send_type);
  Members rest;
  rest.add_text("description", message.description);
  rest.add_attributes(message.attributes);
  rest.add_source(message.source);
  std::string fields;
  for (const FieldModel& field : message.fields)
    fields += (fields.empty() ? "\n        " : ",\n        ") + field_of(field, usual);
  return "    {\n      " + head.text() + ",\n" + (rest.text().empty() ? "" : "      " + rest.text() + ",\n") +
         "      \"fields\": [" + fields + (fields.empty() ? "]" : "\n      ]") + "\n    }";
}

/// What most fields have need not be said with each.
ByteOrder usual_order(const Model& model) {
  std::ptrdiff_t more = 0;
  for (const MessageModel& message : model.messages)
    for (const FieldModel& field : message.fields) more += field.position.order == ByteOrder::big ? 1 : -1;
  return more > 0 ? ByteOrder::big : ByteOrder::little;
}

std::string definition_of(const spec::AttributeDefinitionModel& definition) {
  static constexpr std::string_view objects[] = {"bus", "board", "message", "field"};
  static constexpr std::string_view types[] = {"int", "hex", "float", "string", "enum"};
  Members out;
  out.add_text("of", objects[static_cast<std::size_t>(definition.of)]);
  out.add("name", json(definition.name));
  out.add_text("type", types[static_cast<std::size_t>(definition.type)]);
  out.add_text("min", definition.min);
  out.add_text("max", definition.max);
  out.add_names("values", definition.values);
  if (definition.default_text) out.add("default", json(*definition.default_text));
  return out.object();
}

std::string list_of(const std::vector<std::string>& items) {
  std::string text;
  for (const std::string& item : items) text += (text.empty() ? "" : ",\n") + item;
  return "[\n" + text + "\n  ]";
}

}  // namespace

std::string make_spec(const Model& model, const Options&) {
  const ByteOrder usual = usual_order(model);
  std::vector<std::string> members;
  const auto add = [&](std::string_view name, const std::string& value) {
    members.push_back("  " + json(name) + ": " + value);
  };
  add("robot", json(model.robot));
  if (!model.description.empty()) add("description", json(model.description));
  if (usual == ByteOrder::big) add("byte_order", json("big"));
  if (model.bit_rate != 0) {
    Members bus;
    bus.add("bit_rate", std::to_string(model.bit_rate));
    if (model.data_bit_rate != 0) bus.add("data_bit_rate", std::to_string(model.data_bit_rate));
    bus.add_source(model.bus_source);
    add("bus", bus.object());
  }
  std::vector<std::string> boards;
  for (const auto& board : model.boards) {
    Members out;
    out.add_text("name", board.name);
    out.add_text("description", board.description);
    out.add_text("mcu", board.mcu);
    if (board.clock_hz) out.add("clock_hz", std::to_string(*board.clock_hz));
    if (board.can_clock_hz) out.add("can_clock_hz", std::to_string(*board.can_clock_hz));
    out.add_attributes(board.attributes);
    out.add_source(board.source);
    boards.push_back("    " + out.object());
  }
  if (!boards.empty()) add("boards", list_of(boards));
  std::vector<std::string> messages;
  for (const MessageModel& message : model.messages) messages.push_back(message_of(model, message, usual));
  add("messages", list_of(messages));
  if (!model.attributes.empty()) {
    Members attributes;
    for (const AttributeModel& attribute : model.attributes)
      attributes.add(attribute.name, json(attribute.text));
    add("attributes", attributes.object());
  }
  std::vector<std::string> definitions;
  for (const auto& definition : model.definitions) definitions.push_back("    " + definition_of(definition));
  if (!definitions.empty()) add("attribute_definitions", list_of(definitions));
  std::string text;
  for (const std::string& member : members) text += (text.empty() ? "" : ",\n") + member;
  return "{\n" + text + "\n}\n";
}

}  // namespace ocm::generate
