#include "generator/targets/cpp.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "generator/spec/names.hpp"
#include "generator/spec/worst_bits.hpp"
#include "generator/targets/cpp_messages.hpp"
#include "generator/targets/message_fields.hpp"
#include "generator/text/conversion.hpp"
#include "generator/text/words.hpp"
#include "generator/text/writer.hpp"

namespace ocm::generate {

namespace {

using base::Decimal;
using base::Duration;
using spec::FieldModel;
using spec::FrameModel;
using spec::Model;
using spec::pascal_case;
using spec::TopicModel;

// --- numbers and words -------------------------------------------------------------------------------------

/// A raw number as a literal that has no warning in any type.
std::string literal(std::int64_t number) {
  if (number == INT64_MIN) return "INT64_MIN";
  if (number == INT32_MIN) return "INT32_MIN";
  return number < 0 ? "-" + grouped(static_cast<std::uint64_t>(-number))
                    : grouped(static_cast<std::uint64_t>(number));
}

/// The mask of one bit: 0x01, 0x8000.
std::string mask_literal(std::int64_t bit) {
  base::Text<20> text;
  text << "0x";
  text.hex(std::uint64_t{1} << bit, static_cast<int>(bit / 8 * 2 + 2));
  return std::string{text.view()};
}

std::string chrono(Duration duration) {
  const std::int64_t ns = duration.count();
  if (ns == 0) return "{}";
  const auto as = [](std::string_view unit, std::int64_t count) {
    return " = std::chrono::" + std::string{unit} + "{" + grouped(static_cast<std::uint64_t>(count)) + "}";
  };
  if (ns % 1'000'000'000 == 0) return as("seconds", ns / 1'000'000'000);
  if (ns % 1'000'000 == 0) return as("milliseconds", ns / 1'000'000);
  if (ns % 1'000 == 0) return as("microseconds", ns / 1'000);
  return as("nanoseconds", ns);
}

std::string integer_type(const FieldModel& field) {
  const unsigned width = field.position.width;
  const char* bits = width <= 8 ? "8" : width <= 16 ? "16" : width <= 32 ? "32" : "64";
  return std::string{"std::"} + (field.is_signed ? "int" : "uint") + bits + "_t";
}

bool is_float(const FieldModel& field) {
  return field.number != protocol::Number::integer;
}

std::string member_type(const FieldModel& field) {
  if (is_float(field)) return field.number == protocol::Number::float32 ? "float" : "double";
  return field.is_enumeration() ? pascal_case(field.name) : integer_type(field);
}

std::string bits_alias(const FieldModel& field) {
  return pascal_case(field.name) + "Bits";
}

std::string frame_type(const TopicModel& topic, const FrameModel& frame) {
  return pascal_case(topic.name) + pascal_case(frame.name);
}

// --- one frame ---------------------------------------------------------------------------------------------

/// A name for a parameter or a local that no member of the struct has: members never end in an underscore.
std::string local(const FrameModel& frame, std::string name) {
  for (const FieldModel& field : frame.fields) {
    if (field.name == name) return name + "_";
    for (const auto& value : field.values)
      if (field.flags && value.name == name) return name + "_";
  }
  return name;
}
std::string local(const TopicModel& topic, std::string name) {
  for (const FrameModel& frame : topic.frames)
    if (frame.name == name) return name + "_";
  return name;
}

void write_types(Writer& out, const FrameModel& frame) {
  for (const FieldModel& field : frame.fields) {
    if (!field.is_enumeration()) continue;
    out.open("enum class " + pascal_case(field.name) + " : " + integer_type(field) + " {");
    for (const auto& value : field.values) out.line(value.name + " = " + literal(value.raw) + ",");
    out.close("};");
  }
  for (const FieldModel& field : frame.fields) {
    if (field.is_enumeration()) continue;
    for (const auto& value : field.values)
      out.line("static constexpr " + integer_type(field) + " " +
               (field.flags ? value.name + "_flag = " + mask_literal(value.raw)
                            : field.name + "_" + value.name + " = " + literal(value.raw)) +
               ";");
  }
  const bool any = std::any_of(frame.fields.begin(), frame.fields.end(),
                               [](const FieldModel& field) { return !field.values.empty(); });
  if (any) out.line();
}

void write_members(Writer& out, const FrameModel& frame) {
  std::vector<std::pair<std::string, std::string>> lines;
  for (const FieldModel& field : frame.fields)
    lines.emplace_back(member_type(field) + " " + field.name + (field.is_enumeration() ? "{};" : " = 0;"),
                       remark(field));
  out.remarked(lines);
}

/// A function on one line where it fits.
void write_function(Writer& out, const std::string& head, const std::vector<std::string>& body,
                    std::size_t indent = 2) {
  if (body.size() == 1 && indent + head.size() + 5 + body[0].size() <= columns)
    return out.line(head + " { " + body[0] + " }");
  if (const std::size_t bracket = head.find('('); indent + head.size() + 2 > columns) {
    out.line(head.substr(0, bracket + 1));
    out.open("    " + head.substr(bracket + 1) + " {");
  } else {
    out.open(head + " {");
  }
  for (const std::string& statement : body) out.line(statement);
  out.close("}");
}

std::string physical_of(const FieldModel& field) {
  return to_physical(conversion(field),
                     field.position.width > 32 ? "static_cast<double>(" + field.name + ")" : field.name);
}

void write_accessors(Writer& out, const FrameModel& frame) {
  const std::string value = local(frame, "value");
  const std::string on = local(frame, "on");
  for (const FieldModel& field : frame.fields) {
    if (!field.unit_name.empty()) {
      const std::string name = field.name + "_" + field.unit_name;
      write_function(out, "[[nodiscard]] constexpr double " + name + "() const noexcept",
                     {"return " + physical_of(field) + ";"});
      const std::string setter = "constexpr void set_" + name + "(double " + value + ") noexcept";
      if (is_float(field)) {
        const std::string held = !field.range ? value
                                              : "ocm::protocol::within(" + value + ", " +
                                                    double_literal(field.range->min) + ", " +
                                                    double_literal(field.range->max) + ")";
        const std::string raw = to_raw(conversion(field), held);
        write_function(
            out, setter,
            {field.name + " = " +
             (field.number == protocol::Number::float32 ? "static_cast<float>(" + raw + ")" : raw) + ";"});
        continue;
      }
      out.open(setter + " {");
      std::vector<std::string> arguments{to_raw(conversion(field), value), bits_alias(field) + "::min",
                                         bits_alias(field) + "::max"};
      if (field.has_range) arguments = {arguments[0], literal(field.raw_min), literal(field.raw_max)};
      out.list(field.name + " = ocm::protocol::nearest_raw<" + integer_type(field) + ">(", arguments, ");");
      out.close("}");
    }
    if (!field.flags) continue;
    for (const auto& flag : field.values) {
      write_function(out, "[[nodiscard]] constexpr bool " + flag.name + "() const noexcept",
                     {"return (" + field.name + " & " + flag.name + "_flag) != 0;"});
      write_function(out, "constexpr void set_" + flag.name + "(bool " + on + ") noexcept",
                     {field.name + " = static_cast<" + integer_type(field) + ">(" + on + " ? " + field.name +
                      " | " + flag.name + "_flag : " + field.name + " & ~" + flag.name + "_flag);"});
    }
  }
}

void write_layout(Writer& out, const FrameModel& frame) {
  for (const FieldModel& field : frame.fields) {
    const protocol::Position p = field.position;
    const unsigned type_width = p.width <= 8 ? 8 : p.width <= 16 ? 16 : p.width <= 32 ? 32 : 64;
    const bool big = p.order == protocol::ByteOrder::big;
    std::string arguments = integer_type(field) + ", " + std::to_string(p.start);
    if (p.width != type_width || big) arguments += ", " + std::to_string(p.width);
    if (big) arguments += ", ocm::protocol::ByteOrder::big";
    out.line("using " + bits_alias(field) + " = ocm::protocol::Bits<" + arguments + ">;");
  }
}

void write_codec(Writer& out, const std::string& type, const FrameModel& frame, bool is_topic) {
  const std::string data = local(frame, "data");
  const std::string value = local(frame, "value");
  std::vector<std::string> encode{"ocm::can::Payload " + data + "{};"};
  std::vector<std::string> decode{type + " " + value + ";"};
  for (const FieldModel& field : frame.fields) {
    const std::string bits = bits_alias(field);
    std::string got = bits + "::get(" + data + ")";
    std::string raw =
        field.is_enumeration() ? "static_cast<" + integer_type(field) + ">(" + field.name + ")" : field.name;
    if (field.number == protocol::Number::float32) {
      got = "std::bit_cast<float>(" + got + ")";
      raw = "std::bit_cast<std::uint32_t>(" + raw + ")";
    } else if (is_float(field)) {
      got = "ocm::base::from_binary64(" + got + ")";
      raw = "ocm::base::to_binary64(" + raw + ")";
    }
    encode.push_back(bits + "::put(" + data + ", " + raw + ");");
    decode.push_back(
        value + "." + field.name + " = " +
        (field.is_enumeration() ? "static_cast<" + pascal_case(field.name) + ">(" + got + ")" : got) + ";");
  }
  encode.push_back("return " + data + ";");
  decode.push_back("return " + value + ";");
  if (frame.fields.empty()) {
    encode = {"return {};"};
    decode = {"return {};"};
  }
  write_function(out,
                 std::string{"[[nodiscard]] constexpr ocm::can::Payload encode("} +
                     (is_topic ? "std::size_t /*frame*/ = 0" : "") + ") const noexcept",
                 encode);
  write_function(out,
                 "[[nodiscard]] static constexpr " + type + " decode(const ocm::can::Payload&" +
                     (frame.fields.empty() ? "" : " " + data) + ") noexcept",
                 decode);
}

// --- one topic ---------------------------------------------------------------------------------------------

std::string board_type(const Model& model, const TopicModel& topic) {
  return pascal_case(model.boards[topic.board].name);
}

void write_topic_comment(Writer& out, const Model& model, const TopicModel& topic) {
  std::string text = title(topic.name) + (topic.description.empty() ? ". " : ": " + topic.description + ". ");
  const bool sensor = topic.kind == protocol::Kind::sensor;
  text += sensor ? "Sensor of " : "Actuator of ";
  text += board_type(model, topic) + ", ";
  text += sensor ? "requests on " : "set points on ";
  text += hex(topic.id);
  if (topic.is_group) text += " to " + hex(topic.id + topic.count - 1U);
  text += ".";
  // The sources of single constants stand beside them.
  spec::Source rest{topic.source.general, {}};
  for (const auto& fact : topic.source.particular)
    if (fact.first == "id" || fact.first == "board" || fact.first == "count" || fact.first == "frames" ||
        fact.first == "byte_order" || fact.first == "kind")
      rest.particular.push_back(fact);
  if (!is_aggregate(topic))
    for (const auto& fact : topic.frames.front().source.particular) rest.particular.push_back(fact);
  out.comment(with_source(std::move(text), rest.joined()));
}

/// Of `instances` frames with consecutive ids the greatest, as an initializer.
std::string worst_bits(const TopicModel& topic, const FrameModel& frame, unsigned id, unsigned instances) {
  protocol::BitsByPriority greatest{};
  for (unsigned instance = 0; instance < instances; ++instance) {
    const auto bits = spec::worst_bits(topic.kind, id + instance, frame.dlc);
    for (std::size_t level = 0; level < bits.size(); ++level)
      greatest[level] = std::max(greatest[level], bits[level]);
  }
  std::string text;
  for (const unsigned bits : greatest) text += (text.empty() ? "{" : ", ") + std::to_string(bits);
  return text + "}";
}

std::vector<std::string> frame_heads(const TopicModel& topic) {
  std::vector<std::string> heads;
  for (const FrameModel& frame : topic.frames)
    for (unsigned i = 0; i < frame.count; ++i)
      heads.push_back("{ocm::protocol::TopicId{" + hex(frame.id + i) + "}, " + std::to_string(frame.dlc) +
                      ", " + worst_bits(topic, frame, frame.id + i, topic.count) + "}");
  return heads;
}

void write_constants(Writer& out, const TopicModel& topic) {
  const bool sensor = topic.kind == protocol::Kind::sensor;
  const std::size_t frames = frame_count(topic);
  out.line("static constexpr std::string_view name = " + quoted(topic.name) + ";");
  out.line("static constexpr ocm::protocol::TopicId id{" + hex(topic.id) + "};");
  out.line("static constexpr std::uint8_t instances = " + std::to_string(topic.count) + ";");
  const std::string head =
      "static constexpr std::array<ocm::protocol::FrameHead, " + std::to_string(frames) + "> frames";
  const std::vector<std::string> heads = frame_heads(topic);
  const std::string only = heads.size() == 1 ? "{" + heads.front() + "}};" : "";
  if (!only.empty() && 2 + head.size() + 1 + only.size() <= columns) {
    out.line(head + "{" + only);
  } else if (!only.empty()) {
    out.line(head + "{");
    out.line("    " + only);
  } else {
    out.line(head + "{{");
    for (const std::string& its : heads) out.line("    " + its + ",");
    out.line("}};");
  }
  static constexpr std::string_view units[] = {"milliseconds", "seconds", "microseconds"};
  std::vector<std::pair<std::string, std::string>> lines;
  const auto add = [&](std::string code, std::string_view fact) {
    const std::string& source = topic.source.of(fact);
    lines.emplace_back(std::move(code), &source == &topic.source.general ? "" : "[" + source + "]");
  };
  out.line(std::string{"static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::"} +
           (sensor ? "sensor;" : "actuator;"));
  if (sensor) {
    add("static constexpr ocm::protocol::Period period{" + std::to_string(topic.period.count) +
            ", ocm::protocol::PeriodUnit::" +
            std::string{units[static_cast<std::size_t>(topic.period.unit)]} + "};",
        "period");
    add("static constexpr ocm::base::Duration shortest_period" + chrono(topic.shortest_period) + ";",
        "shortest_period");
  } else {
    add("static constexpr ocm::base::Duration timeout" + chrono(topic.timeout) + ";", "timeout");
  }
  if (topic.role != protocol::Role::none)
    add("static constexpr ocm::protocol::Role role = ocm::protocol::Role::" +
            std::string{protocol::name(topic.role)} + ";",
        "role");
  add("static constexpr ocm::base::Duration deadline" + chrono(topic.deadline) + ";", "deadline");
  add("static constexpr ocm::base::Duration jitter" + chrono(topic.jitter) + ";", "jitter");
  add("static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::" +
          std::string{protocol::name(topic.priority)} + ";",
      "priority");
  out.remarked(lines);
}

void write_equality(Writer& out, const std::string& type) {
  const std::string head = "friend constexpr bool operator==(";
  const std::string argument = "const " + type + "&";
  const std::string tail = argument + ") = default;";
  if (2 + head.size() + argument.size() + 2 + tail.size() <= columns) {
    out.line(head + argument + ", " + tail);
  } else {
    out.line(head + argument + ",");
    out.line(std::string(head.size(), ' ') + tail);
  }
}

void write_fields(Writer& out, const FrameModel& frame) {
  if (frame.fields.empty()) return;
  out.line();
  write_types(out, frame);
  write_members(out, frame);
  const bool has_accessors = std::any_of(frame.fields.begin(), frame.fields.end(),
                                         [](const FieldModel& f) { return !f.unit_name.empty() || f.flags; });
  out.line();
  write_layout(out, frame);
  if (!has_accessors) return;
  out.line();
  write_accessors(out, frame);
}

void write_frame(Writer& out, const TopicModel& topic, const FrameModel& frame) {
  const std::string type = frame_type(topic, frame);
  std::string text = title(topic.name) + ", " + (frame.is_array ? "one " : "") + frame.name;
  text += frame.description.empty() ? "." : ": " + frame.description + ".";
  out.comment(with_source(std::move(text), frame.source.joined()));
  out.open("struct " + type + " {");
  if (frame.is_array) {
    out.line("static constexpr ocm::protocol::TopicId id{" + hex(frame.id) + "};  ///< of the first of " +
             std::to_string(frame.count));
  } else {
    out.line("static constexpr ocm::protocol::TopicId id{" + hex(frame.id) + "};");
  }
  out.line("static constexpr std::uint8_t dlc = " + std::to_string(frame.dlc) + ";");
  write_fields(out, frame);
  out.line();
  write_codec(out, type, frame, false);
  write_equality(out, type);
  out.close("};");
  out.line();
}

void write_single(Writer& out, const TopicModel& topic) {
  const std::string type = pascal_case(topic.name);
  const FrameModel& frame = topic.frames.front();
  const std::string all = local(frame, "all");
  write_fields(out, frame);
  out.line();
  write_codec(out, type, frame, true);
  write_function(out,
                 "[[nodiscard]] static constexpr " + type +
                     " decode(const std::array<ocm::can::Payload, 1>& " + all + ") noexcept",
                 {"return decode(" + all + "[0]);"});
  write_equality(out, type);
}

void write_aggregate(Writer& out, const TopicModel& topic) {
  const std::string type = pascal_case(topic.name);
  out.line();
  for (const FrameModel& frame : topic.frames) {
    const std::string inner = frame_type(topic, frame);
    out.line((frame.is_array ? "std::array<" + inner + ", " + std::to_string(frame.count) + ">" : inner) +
             " " + frame.name + (frame.is_array ? "{};" : ";"));
  }
  out.line();
  const std::string all = local(topic, "all");
  const std::string index = local(topic, "frame");
  const std::string value = local(topic, "value");
  const std::string i = local(topic, "i");
  std::vector<std::string> encode;
  std::vector<std::string> decode{type + " " + value + ";"};
  const auto for_each = [&](const std::string& member, const std::string& statement) {
    const std::string head =
        "for (std::size_t " + i + " = 0; " + i + " < " + member + ".size(); ++" + i + ")";
    if (4 + head.size() + 1 + statement.size() <= columns) return decode.push_back(head + " " + statement);
    decode.push_back(head);
    decode.push_back("  " + statement);
  };
  std::size_t first = 0;
  for (const FrameModel& frame : topic.frames) {
    const std::string inner = frame_type(topic, frame);
    const std::string at = std::to_string(first);
    const std::string member = value + "." + frame.name;
    if (frame.is_array && first == 0) {
      encode.push_back("if (" + index + " < " + frame.name + ".size()) return " + frame.name + "[" + index +
                       "].encode();");
      for_each(member, member + "[" + i + "] = " + inner + "::decode(" + all + "[" + i + "]);");
    } else if (frame.is_array) {
      const std::string end = std::to_string(first + frame.count);
      encode.push_back("if (" + index + " >= " + at + " && " + index + " < " + end + ") return " +
                       frame.name + "[" + index + " - " + at + "].encode();");
      for_each(member, member + "[" + i + "] = " + inner + "::decode(" + all + "[" + at + " + " + i + "]);");
    } else {
      encode.push_back("if (" + index + " == " + at + ") return " + frame.name + ".encode();");
      decode.push_back(member + " = " + inner + "::decode(" + all + "[" + at + "]);");
    }
    first += frame.count;
  }
  encode.push_back("return {};");
  decode.push_back("return " + value + ";");
  out.comment("In the order in which they are sent; no data where there is no such frame.");
  write_function(out,
                 "[[nodiscard]] constexpr ocm::can::Payload encode(std::size_t " + index + ") const noexcept",
                 encode);
  write_function(out,
                 "[[nodiscard]] static constexpr " + type + " decode(const std::array<ocm::can::Payload, " +
                     std::to_string(first) + ">& " + all + ") noexcept",
                 decode);
  write_equality(out, type);
}

void write_topic(Writer& out, const Model& model, const TopicModel& topic) {
  const std::string type = pascal_case(topic.name);
  if (is_aggregate(topic))
    for (const FrameModel& frame : topic.frames) write_frame(out, topic, frame);
  write_topic_comment(out, model, topic);
  out.open("struct " + type + " {");
  write_constants(out, topic);
  if (is_aggregate(topic))
    write_aggregate(out, topic);
  else
    write_single(out, topic);
  out.close("};");
  out.line("static_assert(ocm::protocol::TopicType<" + type + ">);");
  out.line();
}

// --- boards and catalogue ----------------------------------------------------------------------------------

void write_board(Writer& out, const Model& model, std::size_t index) {
  const spec::BoardModel& board = model.boards[index];
  const auto types = [&](protocol::Kind kind) {
    std::vector<std::string> list;
    for (const TopicModel& topic : model.topics)
      if (topic.board == index && topic.kind == kind) list.push_back(pascal_case(topic.name));
    return list;
  };
  out.comment(with_source(
      "The board " + board.name + (board.description.empty() ? "." : ": " + board.description + "."),
      board.source.joined()));
  out.open("struct " + pascal_case(board.name) + " {");
  out.line("static constexpr std::string_view name = " + quoted(board.name) + ";");
  out.line("static constexpr std::string_view mcu = " + quoted(board.mcu) + ";");
  if (board.clock_hz) out.line("static constexpr std::uint32_t clock_hz = " + grouped(*board.clock_hz) + ";");
  if (board.can_clock_hz)
    out.line("static constexpr std::uint32_t can_clock_hz = " + grouped(*board.can_clock_hz) + ";");
  for (const auto& [alias, kind] :
       {std::pair{"sensors", protocol::Kind::sensor}, std::pair{"actuators", protocol::Kind::actuator}}) {
    const auto list = types(kind);
    const std::string head = std::string{"using "} + alias + " = ocm::protocol::TopicList<";
    std::size_t length = 2 + head.size() + 2;
    for (const std::string& type : list) length += type.size() + 2;
    // As clang-format has it: on one line, or on a second one alone, or broken behind the bracket.
    constexpr std::string_view list_type = "    ocm::protocol::TopicList<";
    const std::size_t on_second_line = length - head.size() + list_type.size();
    if (length > columns + 2 && on_second_line <= columns + 2) {
      out.line(std::string{"using "} + alias + " =");
      out.list(list_type, list, ">;");
    } else {
      out.list(head, list, ">;");
    }
  }
  // What the board says of itself; void where the spec has no such topic.
  for (const auto& [alias, role] :
       {std::pair{"status", protocol::Role::status}, std::pair{"refusal", protocol::Role::refusal}}) {
    std::string type = "void";
    for (const TopicModel& topic : model.topics)
      if (topic.board == index && topic.role == role) type = pascal_case(topic.name);
    out.line(std::string{"using "} + alias + " = " + type + ";");
  }
  out.line("static constexpr std::uint32_t wire_hash = " + model.name_space + "::wire_hash;");
  out.close("};");
  out.line();
}

std::string decimal(Decimal number) {
  if (number == Decimal{}) return "{}";
  return "{" + std::to_string(number.digits) + ", " + std::to_string(number.exponent) + "}";
}

std::string frame_space(const TopicModel& topic, const FrameModel& frame) {
  return frame.name.empty() ? topic.name : topic.name + "_" + frame.name;
}

/// Of a float what stands behind the flags: which number, no selector, start, range.
std::string number_of(const FieldModel& field) {
  if (!is_float(field)) return {};
  const std::string kind = field.number == protocol::Number::float32 ? "float32" : "float64";
  std::string text = ", protocol::Number::" + kind;
  if (field.range)
    text += ", protocol::no_selector, {}, 0, " + decimal(field.range->min) + ", " + decimal(field.range->max);
  return text;
}

void write_field_tables(Writer& out, const FrameModel& frame) {
  for (const FieldModel& field : frame.fields) {
    if (field.values.empty()) continue;
    std::vector<std::string> entries;
    for (const auto& value : field.values)
      entries.push_back("{" + literal(value.raw) + ", " + quoted(value.name) + "}");
    out.list("inline constexpr std::array<protocol::NamedValue, " + std::to_string(entries.size()) + "> " +
                 field.name + "_names{{",
             entries, "}};");
  }
  if (frame.fields.empty()) return;
  out.open("inline constexpr std::array<protocol::Field, " + std::to_string(frame.fields.size()) +
           "> fields{{");
  for (const FieldModel& field : frame.fields) {
    const protocol::Position p = field.position;
    out.line(
        "{" + quoted(field.name) + ", {" + std::to_string(p.start) + ", " + std::to_string(p.width) + ", " +
        (p.order == protocol::ByteOrder::big ? "protocol::ByteOrder::big" : "protocol::ByteOrder::little") +
        "}, " + (field.is_signed ? "true" : "false") + ", " + decimal(field.scale) + ", " +
        decimal(field.offset) + ", " + quoted(field.unit) + ", " + literal(field.raw_min) + ", " +
        literal(field.raw_max) + ", " + (field.values.empty() ? "{}" : field.name + "_names") + ", " +
        (field.flags ? "true" : "false") + number_of(field) + "},");
  }
  out.close("}};");
}

std::string shown_name(const FrameModel& frame, unsigned number) {
  return frame.is_array ? "with_derived_" + std::to_string(number + 1) : std::string{"with_derived"};
}

/// Fields and what is derived of them, for each frame of the count.
void write_derived(Writer& out, const FrameModel& frame) {
  if (frame.derived.empty()) return;
  for (const spec::DerivedModel& derived : frame.derived) {
    out.open("inline constexpr std::array<protocol::Law, " + std::to_string(frame.count) + "> " +
             derived.name + "_laws{{");
    for (unsigned i = 0; i < frame.count; ++i) {
      const protocol::Law& law = derived.law(i);
      out.line("{" + decimal(law.at_one) + ", " + decimal(law.offset) + ", " + decimal(law.noise) + ", " +
               decimal(law.min) + ", " + decimal(law.max) + "},");
    }
    out.close("}};");
  }
  for (unsigned i = 0; i < frame.count; ++i) {
    std::vector<std::string> entries;
    for (std::size_t f = 0; f < frame.fields.size(); ++f)
      entries.push_back("fields[" + std::to_string(f) + "]");
    for (const spec::DerivedModel& derived : frame.derived) {
      const auto add = [&](const std::string& name, bool uncertainty) {
        entries.push_back("protocol::derived(fields[" + std::to_string(derived.of) + "], " +
                          std::to_string(derived.of) + ", " + quoted(name) + ", " + quoted(derived.unit) +
                          ", " + derived.name + "_laws[" + std::to_string(i) + "], " +
                          (uncertainty ? "true" : "false") + ")");
      };
      add(derived.name, false);
      if (derived.law(i).noise.digits != 0) add(derived.uncertainty_name(), true);
    }
    out.open("inline constexpr std::array<protocol::Field, " + std::to_string(entries.size()) + "> " +
             shown_name(frame, i) + "{{");
    for (const std::string& entry : entries) out.line(entry + ",");
    out.close("}};");
  }
}

void write_tables(Writer& out, const TopicModel& topic) {
  const bool aggregate = is_aggregate(topic);
  if (aggregate) {
    for (const FrameModel& frame : topic.frames) {
      const std::string space = "namespace " + frame_space(topic, frame);
      if (frame.fields.empty()) continue;
      out.line(space + " {");
      write_field_tables(out, frame);
      write_derived(out, frame);
      out.line("}  // " + space);
    }
  }
  out.line("namespace " + topic.name + " {");
  if (!topic.aliases.empty()) {
    std::vector<std::string> aliases;
    for (const std::string& alias : topic.aliases) aliases.push_back(quoted(alias));
    out.list("inline constexpr std::array<std::string_view, " + std::to_string(aliases.size()) + "> aliases{",
             aliases, "};");
  }
  if (!aggregate) {
    write_field_tables(out, topic.frames.front());
    write_derived(out, topic.frames.front());
  }
  const std::size_t frames = frame_count(topic) * topic.count;
  out.open("inline constexpr std::array<protocol::FrameLayout, " + std::to_string(frames) + "> frames{{");
  for (unsigned instance = 0; instance < topic.count; ++instance) {
    for (const FrameModel& frame : topic.frames) {
      for (unsigned i = 0; i < frame.count; ++i) {
        const std::string name = frame.is_array ? frame.name + "_" + std::to_string(i + 1) : frame.name;
        const std::string fields = frame.fields.empty() ? "{}"
                                   : aggregate          ? frame_space(topic, frame) + "::fields"
                                                        : "fields";
        out.line("{" + quoted(name) + ", protocol::TopicId{" + hex(frame.id + i + instance) + "}, " +
                 std::to_string(frame.dlc) + ", " + fields + ", " +
                 worst_bits(topic, frame, frame.id + i + instance, 1) +
                 (frame.derived.empty()
                      ? ""
                      : ", " + (aggregate ? frame_space(topic, frame) + "::" : std::string{}) +
                            shown_name(frame, i)) +
                 "},");
      }
    }
  }
  out.close("}};");
  out.line("inline constexpr std::string_view source =");
  out.line("  " + quoted(topic.source.joined()) + ";");
  out.line("}  // namespace " + topic.name);
}

void write_topic_row(Writer& out, const TopicModel& topic, unsigned instance) {
  const std::size_t frames = frame_count(topic);
  const std::string type = pascal_case(topic.name);
  const std::string aliases = topic.aliases.empty() ? "{}" : topic.name + "::aliases";
  if (topic.is_group) {
    const std::string its_frames = "{&" + topic.name + "::frames[" + std::to_string(instance * frames) +
                                   "], " + std::to_string(frames) + "}";
    out.line("protocol::catalogue_entry<" + type + ">(" + std::to_string(topic.board) + ", " + aliases +
             ", " + its_frames + ", " + topic.name + "::source, " + std::to_string(instance + 1) + ", " +
             quoted(topic.name + "_" + std::to_string(instance + 1)) + "),");
  } else {
    out.line("protocol::catalogue_entry<" + type + ">(" + std::to_string(topic.board) + ", " + aliases +
             ", " + topic.name + "::frames, " + topic.name + "::source),");
  }
}

void write_catalogue(Writer& out, const Model& model) {
  out.line("// clang-format off");
  out.line("namespace detail {");
  out.line("namespace protocol = ocm::protocol;");
  out.line();
  out.line(
      "// Fields: name, {start, width, order}, signed, scale, offset, unit, lowest and highest raw number,");
  out.line("// names of values or flags, whether flags. Scale and offset: {digits, power of ten}.");
  out.line("// Frames: name, id, DLC, fields, most bits by priority, fields with what is derived of them.");
  out.line("// Laws of what is derived: at one, offset, noise, least and greatest value at which they hold.");
  out.line(
      "// Topics: index of the board, aliases, frames, source, and of several of a kind: number and name.");
  for (const TopicModel& topic : model.topics) {
    out.line();
    write_tables(out, topic);
  }
  out.line();
  out.open("inline constexpr std::array<protocol::Board, " + std::to_string(model.boards.size()) +
           "> boards{{");
  for (const auto& board : model.boards) out.line("{" + quoted(board.name) + ", " + quoted(board.mcu) + "},");
  out.close("}};");
  out.line();
  std::size_t topics = 0;
  for (const TopicModel& topic : model.topics) topics += topic.count;
  out.open("inline constexpr std::array<protocol::Topic, " + std::to_string(topics) + "> topics{{");
  for (const TopicModel& topic : model.topics)
    for (unsigned i = 0; i < topic.count; ++i) write_topic_row(out, topic, i);
  out.close("}};");
  out.line("}  // namespace detail");
  out.line("// clang-format on");
  out.line();
  out.comment("Everything that is said on the bus, as a tool sees it that loads the spec when it runs.");
  out.line("inline constexpr ocm::protocol::Catalogue catalogue{" + quoted(model.robot) +
           ", bit_rate, detail::boards, detail::topics};");
  out.line();
  out.comment("What tells a board that was built from another spec: boards report it in their status.");
  out.line("inline constexpr std::uint32_t wire_hash = ocm::protocol::wire_hash(catalogue);");
}

/// Among the topics' fields.
bool has_floats(const Model& model) {
  for (const TopicModel& topic : model.topics)
    for (const FrameModel& frame : topic.frames)
      if (std::any_of(frame.fields.begin(), frame.fields.end(), is_float)) return true;
  return false;
}

std::string sentence(std::string text) {
  return text.ends_with('.') ? text : text + '.';
}

}  // namespace

std::string header(const Model& model, std::string_view spec_name) {
  const bool topics = !model.topics.empty();
  const bool messages = !model.messages.empty();
  const std::string space = name_space_of(model);
  Writer out;
  out.comment("Made by ocm-generate from " + std::string{spec_name} +
                  ". Do not edit: change the spec, and generate again.",
              "// ");
  out.line();
  const std::string_view what = topics && messages ? "topics and messages" : topics ? "topics" : "messages";
  out.comment("The " + std::string{what} + " of " + model.robot +
              (model.description.empty() ? "." : ": " + sentence(comment_text(model.description))));
  if (topics) {
    out.line("///");
    out.comment(
        "Members of a frame are raw numbers, as they travel. name_unit() is the physical value, rounded once "
        "where "
        "raw number times scale stays below 2^53; set_name_unit() takes the nearest raw number within the "
        "field's "
        "range, and the one nearest to zero for not a number. encode() puts the nearest number that the "
        "width "
        "holds. `frames` has of each frame the id, the DLC, and the most bits that it takes on the bus at "
        "each "
        "priority, whatever its content. No heap, no exceptions; everything is constexpr.");
  }
  if (messages) {
    out.line("///");
    out.comment(
        "A message is its bytes, which begin with the start values; what they mean is read and put in place. "
        "Name() is the physical value, the named one or the number, Name_raw() the bits; set_Name() takes "
        "the "
        "nearest that the width holds. Of a multiplexed field Name() is empty where the selector says that "
        "it "
        "is not there, and set_Name() is false. ocm/protocol/message.hpp makes frames of them, and reads "
        "them.");
  }
  if (const std::string source = model.defaults_source.joined(); !source.empty()) {
    out.line("///");
    out.comment("Where a period, deadline, jitter, priority or timeout names no source: [" + source + "]");
  }
  out.line("#pragma once");
  out.line();
  std::vector<std::string_view> standard{"array", "chrono", "cstddef", "cstdint", "string_view"};
  if (messages) standard = {"array", "bit", "cstddef", "cstdint", "optional", "span", "string_view"};
  if (messages && topics) standard.insert(standard.begin() + 2, "chrono");
  const bool floats = has_floats(model);
  if (floats && !messages) standard.insert(standard.begin() + 1, "bit");
  for (const std::string_view name : standard) out.line("#include <" + std::string{name} + ">");
  out.line();
  std::vector<std::string_view> own{"ocm/base/time.hpp",         "ocm/can/frame.hpp",
                                    "ocm/protocol/codec.hpp",    "ocm/protocol/identifier.hpp",
                                    "ocm/protocol/physical.hpp", "ocm/protocol/request.hpp",
                                    "ocm/protocol/topic.hpp",    "ocm/protocol/wire_hash.hpp"};
  if (messages) {
    own.insert(own.begin(), "ocm/base/binary64.hpp");
    own.insert(std::find(own.begin(), own.end(), "ocm/protocol/physical.hpp"),
               {"ocm/protocol/message.hpp", "ocm/protocol/message_field.hpp"});
    if (!topics)
      for (const std::string_view name :
           {"ocm/protocol/identifier.hpp", "ocm/protocol/request.hpp", "ocm/protocol/wire_hash.hpp",
            "ocm/protocol/physical.hpp", "ocm/can/frame.hpp"})
        std::erase(own, name);
  }
  if (floats && !messages) own.insert(own.begin(), "ocm/base/binary64.hpp");
  for (const std::string_view name : own) out.line("#include \"" + std::string{name} + "\"");
  out.line();
  out.line("namespace " + space + " {");
  out.line();
  if (model.bit_rate != 0) {
    out.comment(with_source("Bits per second on the bus.", model.bus_source.joined()));
    out.line("inline constexpr std::uint32_t bit_rate = " + grouped(model.bit_rate) + ";");
    out.line();
  }
  for (const TopicModel& topic : model.topics) write_topic(out, model, topic);
  if (messages) write_messages(out, model);
  if (topics) {
    write_catalogue(out, model);
    out.line();
    for (std::size_t i = 0; i < model.boards.size(); ++i)
      if (!model.boards[i].mcu.empty()) write_board(out, model, i);
  }
  out.line("}  // namespace " + space);
  return out.take();
}

}  // namespace ocm::generate
