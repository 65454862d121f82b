#include "generator/targets/cpp.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "generator/spec/names.hpp"
#include "generator/targets/cpp_messages.hpp"
#include "generator/targets/cpp_topics.hpp"
#include "generator/targets/message_fields.hpp"
#include "generator/text/words.hpp"
#include "generator/text/writer.hpp"

namespace ocm::generate {

namespace {

using base::Decimal;
using spec::FieldModel;
using spec::FrameModel;
using spec::Model;
using spec::pascal_case;
using spec::TopicModel;

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
      entries.push_back("{" + cpp_literal(value.raw) + ", " + quoted(value.name) + "}");
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
        decimal(field.offset) + ", " + quoted(field.unit) + ", " + cpp_literal(field.raw_min) + ", " +
        cpp_literal(field.raw_max) + ", " + (field.values.empty() ? "{}" : field.name + "_names") + ", " +
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
