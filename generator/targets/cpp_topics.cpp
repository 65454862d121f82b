#include "generator/targets/cpp_topics.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "generator/spec/names.hpp"
#include "generator/spec/worst_bits.hpp"
#include "generator/text/conversion.hpp"
#include "generator/text/words.hpp"

namespace ocm::generate {
namespace {

using base::Duration;
using spec::FieldModel;
using spec::FrameModel;
using spec::Model;
using spec::pascal_case;
using spec::TopicModel;

// --- numbers and words -------------------------------------------------------------------------------------

/// The mask of one bit: 0x01, 0x8000.
std::string mask_literal(std::int64_t bit) {
  base::Text<18> text;
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
    for (const auto& value : field.values) out.line(value.name + " = " + cpp_literal(value.raw) + ",");
    out.close("};");
  }
  for (const FieldModel& field : frame.fields) {
    if (field.is_enumeration()) continue;
    for (const auto& value : field.values)
      out.line("static constexpr " + integer_type(field) + " " +
               (field.flags ? value.name + "_flag = " + mask_literal(value.raw)
                            : field.name + "_" + value.name + " = " + cpp_literal(value.raw)) +
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
      if (field.has_range) arguments = {arguments[0], cpp_literal(field.raw_min), cpp_literal(field.raw_max)};
      out.assignment(field.name, "ocm::protocol::nearest_raw<" + integer_type(field) + ">(", arguments, ");");
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
  if (heads.size() == 1) {
    out.line(head + "{");
    out.line("    {" + heads.front() + "}};");
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

}  // namespace

std::string cpp_literal(std::int64_t number) {
  if (number == INT64_MIN) return "INT64_MIN";
  if (number == INT32_MIN) return "INT32_MIN";
  return number < 0 ? "-" + grouped(static_cast<std::uint64_t>(-number))
                    : grouped(static_cast<std::uint64_t>(number));
}

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

}  // namespace ocm::generate
