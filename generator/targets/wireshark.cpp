/// A dissector in Lua for Wireshark and tshark from 3.6 on (Lua 5.2), on CAN frames however they were
/// captured. Fields are amiro.gyroscope.x, amiro.odometry.pose.x where a topic has several frames, and
/// car.Engine.Speed of a plain message. Values are doubles, rounded once as in the C++ header; whole numbers
/// of any width are exact.
#include <algorithm>
#include <iterator>
#include <set>
#include <string_view>

#include "generator/targets/cpp_messages.hpp"
#include "generator/targets/message_fields.hpp"
#include "generator/targets/target.hpp"
#include "generator/targets/wireshark_text.hpp"
#include "generator/text/conversion.hpp"
#include "generator/text/messages.hpp"
#include "generator/text/words.hpp"
#include "generator/text/writer.hpp"

namespace ocm::generate {
namespace {

using protocol::Number;
using spec::FieldModel;
using spec::MessageModel;
using spec::Model;

/// What the protocol is called. Wireshark has protocols of some names already that a file about a CAN bus may
/// have, and loads no second one.
std::string protocol_of(const Model& model) {
  static constexpr std::string_view taken[] = {"can",    "caneth",   "canopen", "data", "devicenet", "frame",
                                               "isobus", "iso15765", "j1939",   "lin",  "obd",       "uds"};
  const std::string name = name_space_of(model);
  const bool is_taken = std::find(std::begin(taken), std::end(taken), name) != std::end(taken);
  return is_taken ? name + "_bus" : name;
}

/// What a frame is found by: its identifier without the priority.
std::string key_of(const Message& message) {
  base::Text<8> text;
  text << "0x";
  text.hex((message.is_sensor() ? 0x400U : 0U) | message.id, 3);
  return std::string{text.view()};
}

/// Lua has no ' between thousands.
std::string plain(std::string text) {
  text.erase(std::remove(text.begin(), text.end(), '\''), text.end());
  return text;
}

/// A string of Lua with any text in it.
std::string lua_text(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < ' ' || byte == 0x7F) {
      out += {'\\', static_cast<char>('0' + byte / 100), static_cast<char>('0' + byte / 10 % 10)};
      out += static_cast<char>('0' + byte % 10);
      continue;
    }
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

/// `more`: what a message's field has, with a comma in front.
std::string field_row(const FieldModel& field, const std::string& abbreviation,
                      const std::string& more = {}) {
  const protocol::Position at = field.position;
  std::string row = "{ name = " + lua_text(field.name);
  if (abbreviation != field.name) row += ", abbreviation = " + lua_text(abbreviation);
  row += ", start = " + std::to_string(at.start) + ", width = " + std::to_string(at.width) + more;
  if (at.order == protocol::ByteOrder::big) row += ", big = true";
  if (field.number != Number::integer)
    row += ", float = true";
  else if (field.is_signed)
    row += ", signed = true";
  if (!field.unit.empty()) row += ", unit = " + lua_text(field.unit);
  const bool scaled = field.scale != base::Decimal{1, 0} || field.offset.digits != 0;
  if (scaled)
    row += ", physical = function(raw) return " + plain(to_physical(conversion(field), "raw")) + " end";
  if (field.values.empty()) return row + " }";
  row += field.flags ? ", flags = {" : ", names = {";
  for (const auto& value : field.values)
    row += " [" + std::to_string(value.raw) + "] = " + lua_text(value.name) + ",";
  return row + " } }";
}

std::string with_names(std::string_view text, const Model& model) {
  std::string out;
  for (; !text.empty(); text.remove_prefix(1)) {
    if (text.starts_with("@title")) {
      out += lua_text(model.robot);
      text.remove_prefix(5);
    } else if (text.front() == '@') {
      out += protocol_of(model);
    } else {
      out += text.front();
    }
  }
  return out;
}

void write_frame(Writer& out, const Message& message) {
  const std::string head = "frames[" + key_of(message) + "] = { topic = " + lua_text(message.topic_name) +
                           ", frame = " + lua_text(message.frame_name) +
                           ", dlc = " + std::to_string(message.frame->dlc) + ", fields = {";
  if (message.frame->fields.empty()) return out.line(head + "} }");
  out.open(head);
  for (const FieldModel& field : message.frame->fields) out.line(field_row(field, field.name) + ",");
  out.close("} }");
}

// --- plain messages ---

/// Where its selector is in the list of fields, from 1 on, and the selector's numbers.
std::string selection_of(const MessageModel& message, const FieldModel& field) {
  if (field.selector.empty()) return {};
  std::size_t place = 0;
  for (std::size_t i = 0; i < message.fields.size(); ++i)
    if (message.fields[i].name == field.selector) place = i + 1;
  std::string text = ", selector = " + std::to_string(place) + ", selected = {";
  for (const auto& range : field.selected)
    text += " { " + std::to_string(range.first) + ", " + std::to_string(range.last) + " },";
  text.back() = ' ';
  return text + "}";
}

void write_message(Writer& out, const Model& model, const MessageModel& message, Scope& names) {
  const auto& address = message.address;
  const std::string table = message.is_j1939() ? "group_messages"
                            : address.extended ? "extended_messages"
                                               : "base_messages";
  const std::string key = message.is_j1939() ? hexadecimal(group_of(address), 5)
                                             : hexadecimal(address.number, address.extended ? 8 : 3);
  // What of a group of more than eight bytes fits into a frame is sent in one.
  const bool any_length = message.is_j1939() && message.length > 8;
  std::string head = table + "[" + key + "] = { name = " + lua_text(message.name) +
                     ", abbreviation = " + lua_text(names.claim(cpp_name(message.name), {{"", ""}})) +
                     ", length = " + std::to_string(any_length ? 0 : message.length);
  if (message.board < model.boards.size()) head += ", sender = " + lua_text(model.boards[message.board].name);
  head += ", fields = {";
  if (message.fields.empty()) return out.line(head + "} }");
  out.open(head);
  std::set<std::string> taken;
  Scope fields{taken};
  for (const FieldModel& field : message.fields)
    out.line(field_row(field, fields.claim(cpp_name(field.name), {{"", ""}}), selection_of(message, field)) +
             ",");
  out.close("} }");
}

std::string topic_tables(const Model& model) {
  Writer out;
  for (const auto& topic : model.topics)
    if (topic.kind == protocol::Kind::sensor)
      out.line("sensors[" + hex(topic.id) + "] = { topic = " + lua_text(topic.name) +
               ", period = " + print(base::normalised(topic.period.duration().count(), -9)) + " }");
  for (const Message& message : messages(model)) write_frame(out, message);
  return out.take();
}

std::string message_tables(const Model& model) {
  Writer out;
  std::set<std::string> taken;
  for (const auto& topic : model.topics) taken.insert(topic.name);
  Scope names{taken};
  for (const MessageModel& message : model.messages) write_message(out, model, message, names);
  return out.take();
}

}  // namespace

std::string make_wireshark(const Model& model, const Options& options) {
  Writer out;
  out.comment("Made by ocm-generate from " + options.spec_name +
                  ". Do not edit: change the spec, and generate again.",
              "-- ");
  out.line("--");
  const bool topics = !model.topics.empty(), has_messages = !model.messages.empty();
  out.comment((topics && has_messages ? "The topics and messages of "
               : has_messages         ? "The messages of "
                                      : "The topics of ") +
                  comment_text(model.robot) + " for Wireshark and tshark: wireshark -X lua_script:" +
                  protocol_of(model) + ".lua FILE, or put it into the folder of personal Lua plugins.",
              "-- ");
  std::string text = out.take() + with_names(lua::opening, model);
  if (topics) text += with_names(lua::topic_opening, model) + topic_tables(model);
  if (has_messages) text += with_names(lua::message_opening, model) + message_tables(model);
  text += with_names(lua::fields, model);
  if (topics) text += with_names(lua::topic_part, model);
  if (has_messages) text += with_names(lua::message_part, model);
  text += with_names(lua::closing, model);
  if (topics) text += with_names(lua::topic_closing, model);
  if (has_messages) text += with_names(lua::message_closing, model);
  return text;
}

}  // namespace ocm::generate
