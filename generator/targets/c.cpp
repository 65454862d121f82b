/// A C99 header of its own: for firmware in C, and for code that Simulink generated. Compared with a plain
/// translation of a DBC file it delivers whole samples: from a frame to a struct and back in one call, with
/// scaled accessors, identifiers with priority, and the requests that no DBC can describe.
#include <algorithm>
#include <initializer_list>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "generator/targets/c_helpers.hpp"
#include "generator/targets/c_messages.hpp"
#include "generator/targets/c_requests_text.hpp"
#include "generator/targets/c_text.hpp"
#include "generator/targets/cpp_messages.hpp"
#include "generator/targets/message_fields.hpp"
#include "generator/targets/target.hpp"
#include "generator/text/conversion.hpp"
#include "generator/text/messages.hpp"
#include "generator/text/words.hpp"
#include "generator/text/writer.hpp"

namespace ocm::generate {
namespace {

using spec::FieldModel;
using spec::FrameModel;
using spec::Model;
using spec::TopicModel;

/// The one word of C99 that C++ has not, so that a spec allows it. [ISO C99, 6.4.1]
std::string member(const std::string& name) {
  return name == "restrict" ? "restrict_" : name;
}

bool is_float(const FieldModel& field) {
  return field.number != protocol::Number::integer;
}
std::string member_type(const FieldModel& field) {
  if (!is_float(field)) return type_of(field);
  return field.number == protocol::Number::float32 ? "float" : "double";
}

class Header {
 public:
  Header(const Model& model, const Options& options)
      : model_(model),
        options_(options),
        robot_(name_space_of(model)),
        macro_(upper(robot_)),
        taken_(names_of_helpers(robot_)) {
    if (!model_.topics.empty()) taken_.merge(names_in(c_request_part, robot_));
    if (model_.bit_rate != 0) taken_.insert(macro_ + "_BIT_RATE");
    claim_names();
  }

  std::string make() {
    for (const TopicModel& topic : model_.topics) write_topic(topic);
    write_c_messages(out_, model_, taken_);
    const std::string body = out_.take();
    const std::string helpers = helpers_of(body, robot_);
    out_ = Writer{};
    opening(helpers.find("memcpy") != std::string::npos);
    if (!model_.topics.empty()) out_.text(named(c_request_part, robot_));
    out_.text(helpers);
    out_.text(body);
    out_.line("#ifdef __cplusplus");
    out_.line("}");
    out_.line("#endif");
    out_.line();
    out_.line("#endif");
    return out_.take();
  }

 private:
  // --- names -----------------------------------------------------------------------------------------------

  /// Words joined by underscores may meet: what does so gets one more.
  std::string unique(std::string name) {
    while (!taken_.insert(name).second) name += '_';
    return name;
  }
  /// Names of types and of what is made with them, before any other: those that a type begins must be its
  /// own.
  void claim_names() {
    const auto claim = [this](std::string stem, std::initializer_list<const char*> ends) {
      const auto is_free = [&] {
        return std::none_of(ends.begin(), ends.end(),
                            [&](const char* end) { return taken_.count(stem + end) != 0; });
      };
      while (!is_free()) stem += '_';
      for (const char* const end : ends) taken_.insert(stem + end);
      return stem;
    };
    for (const TopicModel& topic : model_.topics) {
      const std::string name = robot_ + "_" + topic.name;
      if (!is_aggregate(topic)) {
        stems_[&topic] = stems_[&topic.frames.front()] =
            claim(name, {"_t", "_encode", "_decode", "_frame", "_take"});
        continue;
      }
      stems_[&topic] = claim(name, {"_t", "_frame", "_take"});
      for (const FrameModel& frame : topic.frames)
        stems_[&frame] = claim(name + "_" + frame.name, {"_t", "_encode", "_decode"});
    }
  }

  // --- the robot -------------------------------------------------------------------------------------------

  void opening(bool copies) {
    out_.comment("Made by ocm-generate from " + options_.spec_name +
                     ". Do not edit: change the spec, and generate again.",
                 "// ");
    out_.line("//");
    const bool topics = !model_.topics.empty(), messages = !model_.messages.empty();
    std::string what = topics && messages ? "The topics and messages of "
                       : messages         ? "The messages of "
                                          : "The topics of ";
    what += model_.robot;
    if (!model_.description.empty()) what += ": " + model_.description;
    out_.comment(comment_text(std::move(what)), "// ");
    out_.line("//");
    out_.comment("For C99 and C++11. No other file is needed, nothing is to be linked, and there is no heap.",
                 "// ");
    out_.line("//");
    if (topics)
      out_.comment(
          "A struct has raw numbers, as they travel. _x_unit() is the physical value of x, and set_x_unit() "
          "takes the nearest raw number within the field's range (not a number: the one nearest to zero). "
          "_frame() makes the CAN frame of a struct, _take() fills the struct from one. _encode() puts the "
          "nearest number that the width holds.",
          "// ");
    if (topics && messages) out_.line("//");
    if (messages) out_.comment(c_messages_say, "// ");
    const std::string guard = macro_ + (topics ? "_TOPICS_H" : "_MESSAGES_H");
    out_.line("#ifndef " + guard);
    out_.line("#define " + guard);
    out_.line();
    out_.line("#include <stdint.h>");
    if (copies) out_.line("#include <string.h>");
    out_.line();
    out_.line("#ifdef __cplusplus");
    out_.line("extern \"C\" {");
    out_.line("#endif");
    out_.line();
    if (model_.bit_rate == 0) return;
    comment(with_source("Bits per second on the bus.", model_.bus_source.joined()));
    out_.line("#define " + macro_ + "_BIT_RATE " + std::to_string(model_.bit_rate) + "u");
    out_.line();
  }

  void comment(std::string_view text) { out_.comment(text, "// "); }

  void define(const std::string& name, const std::string& value) {
    out_.line("#define " + unique(macro_ + "_" + name) + " " + value);
  }

  // --- one frame -------------------------------------------------------------------------------------------

  void write_struct(const std::string& name, const FrameModel& frame) {
    std::vector<std::pair<std::string, std::string>> lines;
    out_.open("typedef struct " + name + "_t {");
    for (const FieldModel& field : frame.fields) {
      std::string text = remark(field);
      if (field.flags || !field.values.empty()) text = text.empty() ? "see below" : text + "; see below";
      out_.comment(text, "// ");
      out_.line(member_type(field) + " " + member(field.name) + ";");
    }
    if (frame.fields.empty()) out_.line("uint8_t nothing;  // C has no empty struct");
    out_.close("} " + name + "_t;");
  }

  void write_values(const std::string& name, const FrameModel& frame) {
    const std::string prefix = upper(name.substr(robot_.size() + 1)) + "_";
    for (const FieldModel& field : frame.fields)
      for (const auto& value : field.values)
        define(prefix + upper(field.name) + "_" + upper(value.name),
               field.flags     ? word_literal(std::uint64_t{1} << value.raw, is_wide(field))
               : value.raw < 0 ? "(" + literal(value.raw) + ")"
                               : literal(value.raw));
  }

  void write_encode(const std::string& name, const FrameModel& frame) {
    out_.open("static inline void " + name + "_encode(const " + name + "_t* value, uint8_t data[8]) {");
    std::vector<std::string> bytes[8];
    for (const FieldModel& field : frame.fields) {
      const std::string bits = field.name + "_bits";
      const std::string its = "value->" + member(field.name);
      if (is_float(field))
        out_.line("const " + word_type(field) + " " + bits + " = " + robot_ + "_bits_of_" +
                  member_type(field) + "(" + its + ");");
      else
        out_.line("const " + word_type(field) + " " + bits + " = (" + word_type(field) + ")" +
                  held(field, its, robot_) + ";");
      for (const Piece& piece : pieces_of(field.position))
        bytes[piece.byte].push_back(
            shifted(masked(shifted(bits, ">>", piece.from), piece.width), "<<", piece.shift));
    }
    if (frame.fields.empty()) out_.line("(void)value;");
    for (std::size_t i = 0; i < 8; ++i) {
      std::string sum;
      for (const std::string& term : bytes[i]) sum += (sum.empty() ? "" : " | ") + term;
      if (bytes[i].size() != 1 || sum.front() != '(') sum = "(" + sum + ")";
      const std::string byte = "data[" + std::to_string(i) + "] = ";
      out_.line(byte + (bytes[i].empty() ? "0" : "(uint8_t)" + sum) + ";");
    }
    out_.close("}");
  }

  void write_decode(const std::string& name, const FrameModel& frame) {
    out_.open("static inline void " + name + "_decode(" + name + "_t* value, const uint8_t data[8]) {");
    for (const FieldModel& field : frame.fields) {
      std::vector<std::string> terms;
      for (const Piece& piece : pieces_of(field.position)) {
        const std::string byte = "(" + word_type(field) + ")data[" + std::to_string(piece.byte) + "]";
        terms.push_back(shifted(masked(shifted(byte, ">>", piece.shift), piece.width), "<<", piece.from));
      }
      for (std::size_t i = 0; i + 1 < terms.size(); ++i) terms[i] += " |";
      const unsigned width = field.position.width;
      const std::string bits = field.name + "_bits";
      std::string head = "const " + word_type(field) + " " + bits + " =";
      for (const std::string& term : terms) head += " " + term;
      if (head.size() + 3 <= columns) {
        out_.line(head + ";");
      } else {
        out_.open("const " + word_type(field) + " " + bits + " =");
        for (std::size_t i = 0; i < terms.size(); ++i)
          out_.line(terms[i] + (i + 1 < terms.size() ? "" : ";"));
        out_.undent();
      }
      const std::string sign = word_literal(std::uint64_t{1} << (width - 1), is_wide(field));
      const bool extended = field.is_signed && width != 32 && width != 64;
      if (is_float(field)) {
        out_.line("value->" + member(field.name) + " = " + robot_ + "_" + member_type(field) + "_of(" + bits +
                  ");");
        continue;
      }
      out_.line("value->" + member(field.name) + " = (" + type_of(field) + ")" +
                (extended ? "((" + bits + " ^ " + sign + ") - " + sign + ")" : bits) + ";");
    }
    if (frame.fields.empty()) {
      out_.line("(void)data;");
      out_.line("value->nothing = 0;");
    }
    out_.close("}");
  }

  void write_accessors(const std::string& name, const FrameModel& frame) {
    for (const FieldModel& field : frame.fields) {
      if (field.unit_name.empty()) continue;
      const std::string what = field.name + "_" + field.unit_name;
      const Conversion c = conversion(field);
      const std::string raw = "(double)value->" + member(field.name);
      out_.open("static inline double " + unique(name + "_" + what) + "(const " + name + "_t* value) {");
      out_.line("return " + without_marks(to_physical(c, raw)) + ";");
      out_.close("}");
      out_.open("static inline void " + unique(name + "_set_" + what) + "(" + name + "_t* value, double " +
                field.unit_name + "_) {");
      if (is_float(field)) {
        const std::string value = field.unit_name + "_";
        const std::string held = !field.range
                                     ? value
                                     : robot_ + "_within(" + value + ", " + double_literal(field.range->min) +
                                           ", " + double_literal(field.range->max) + ")";
        out_.line("value->" + member(field.name) + " = (" + member_type(field) + ")(" +
                  without_marks(to_raw(c, held)) + ");");
        out_.close("}");
        continue;
      }
      out_.line("value->" + member(field.name) + " = (" + type_of(field) + ")" + robot_ + "_nearest(" +
                without_marks(to_raw(c, field.unit_name + "_")) + ", " + literal(field.raw_min) + ", " +
                literal(field.raw_max) + ");");
      out_.close("}");
    }
  }

  void write_frame(const TopicModel& topic, const FrameModel& frame) {
    const std::string name = stems_.at(&frame);
    comment(with_source(title(topic.name) + (is_aggregate(topic) ? ", " + frame.name : "") +
                            (frame.description.empty() ? "" : ": " + frame.description) + ".",
                        frame.source.joined()));
    write_struct(name, frame);
    write_values(name, frame);
    write_encode(name, frame);
    write_decode(name, frame);
    write_accessors(name, frame);
    out_.line();
  }

  // --- one topic -------------------------------------------------------------------------------------------

  struct Slot {
    std::string member;  ///< "value->pose", "value->sensor[3]", "value"
    std::string stem;
    unsigned id = 0;
    unsigned dlc = 0;
  };

  std::vector<Slot> slots_of(const TopicModel& topic) const {
    std::vector<Slot> slots;
    for (const FrameModel& frame : topic.frames)
      for (unsigned i = 0; i < frame.count; ++i) {
        std::string place = "value";
        if (is_aggregate(topic)) place = "&value->" + member(frame.name);
        if (frame.is_array) place += "[" + std::to_string(i) + "]";
        slots.push_back({std::move(place), stems_.at(&frame), frame.id + i, frame.dlc});
      }
    return slots;
  }

  void write_topic(const TopicModel& topic) {
    const bool sensor = topic.kind == protocol::Kind::sensor;
    const std::string name = stems_.at(&topic);
    const std::string name_macro = upper(topic.name);
    out_.line("// --- " + topic.name);
    out_.line();
    for (const FrameModel& frame : topic.frames) write_frame(topic, frame);
    std::string what = title(topic.name) + (topic.description.empty() ? "" : ": " + topic.description) + ". ";
    what += (sensor ? "Sensor of " : "Actuator of ") + model_.boards[topic.board].name + ".";
    comment(with_source(std::move(what), topic.source.joined()));
    define(name_macro + "_ID", hex(topic.id) + "u");
    define(name_macro + "_PRIORITY", macro_ + "_" + upper(std::string{protocol::name(topic.priority)}));
    if (topic.is_group) define(name_macro + "_COUNT", std::to_string(topic.count) + "u");
    if (sensor) define(name_macro + "_FRAMES", std::to_string(frame_count(topic)) + "u");
    if (is_aggregate(topic)) {
      out_.open("typedef struct " + name + "_t {");
      for (const FrameModel& frame : topic.frames)
        out_.line(stems_.at(&frame) + "_t " + member(frame.name) +
                  (frame.is_array ? "[" + std::to_string(frame.count) + "]" : "") + ";");
      out_.close("} " + name + "_t;");
    }
    write_make_frame(topic, slots_of(topic));
    write_take(topic, slots_of(topic));
    out_.line();
  }

  void write_make_frame(const TopicModel& topic, const std::vector<Slot>& slots) {
    const std::string name = stems_.at(&topic);
    const bool several = slots.size() > 1;
    const std::string index = several ? ", uint8_t index" : topic.is_group ? ", uint8_t number" : "";
    const std::string identifier =
        robot_ + (topic.kind == protocol::Kind::sensor ? "_sample_id(" : "_command_id(");
    if (topic.is_group)
      comment("Number 1 to " + std::to_string(topic.count) + "; 0 is the first, any other the last.");
    if (several)
      comment("Frame `index`, from 0 to " + std::to_string(slots.size() - 1) +
              ", in the order in which they are sent; any other is the last.");
    const std::string head = "static inline " + robot_ + "_frame " + name + "_frame(";
    out_.line(head + "const " + name + "_t* value" + index + ",");
    out_.open(std::string(head.size(), ' ') + robot_ + "_priority priority) {");
    out_.line(robot_ + "_frame frame = {0, " + std::to_string(slots.front().dlc) +
              ", {0, 0, 0, 0, 0, 0, 0, 0}};");
    const auto fill = [&](const Slot& slot, const std::string& id) {
      if (slot.dlc != slots.front().dlc) out_.line("frame.dlc = " + std::to_string(slot.dlc) + ";");
      out_.line("frame.id = " + identifier + id + ", priority);");
      out_.line(slot.stem + "_encode(" + slot.member + ", frame.data);");
    };
    if (!several) {
      const std::string count = std::to_string(topic.count), last = std::to_string(topic.count - 1);
      fill(slots.front(), topic.is_group
                              ? "(uint8_t)(" + hex(slots.front().id) + "u + (number < 1u ? 0u : number < " +
                                    count + "u ? number - 1u : " + last + "u))"
                              : hex(slots.front().id));
    } else {
      out_.line("switch (index) {");
      for (std::size_t i = 0; i < slots.size(); ++i) {
        out_.open(i + 1 < slots.size() ? "case " + std::to_string(i) + ":" : "default:");
        fill(slots[i], hex(slots[i].id));
        out_.line("break;");
        out_.undent();
      }
      out_.line("}");
    }
    out_.line("return frame;");
    out_.close("}");
  }

  void write_take(const TopicModel& topic, const std::vector<Slot>& slots) {
    const std::string name = stems_.at(&topic);
    const bool sensor = topic.kind == protocol::Kind::sensor;
    std::string says = "Whatever the priority. ";
    says += topic.is_group ? "The number of the one it was for, from 1; "
            : slots.size() > 1
                ? "Which frame it was, from 0; a sample is complete when its last frame came after "
                  "all others; "
                : "0; ";
    comment(says + "or " + macro_ + "_FOREIGN, or " + macro_ + "_WRONG_LENGTH, and the struct is as it was.");
    const std::string head = "static inline int " + name + "_take(";
    out_.line(head + name + "_t* value,");
    out_.open(std::string(head.size(), ' ') + "const " + robot_ + "_frame* frame) {");
    if (topic.is_group)
      out_.line("const uint8_t index = (uint8_t)(" + robot_ + "_topic_of(frame->id) - " +
                hex(slots.front().id) + "u);");
    out_.line("if (frame->id > 0x7FFu || " + std::string{sensor ? "!" : ""} + robot_ +
              "_is_sample(frame->id)) return " + macro_ + "_FOREIGN;");
    const auto decode = [&](const Slot& slot, const std::string& result) {
      out_.line("if (frame->dlc != " + std::to_string(slot.dlc) + ") return " + macro_ + "_WRONG_LENGTH;");
      out_.line(slot.stem + "_decode(" + slot.member + ", frame->data);");
      out_.line("return " + result + ";");
    };
    if (topic.is_group) {
      out_.line("if (index >= " + std::to_string(topic.count) + "u) return " + macro_ + "_FOREIGN;");
      decode(slots.front(), "index + 1");
    } else if (slots.size() == 1) {
      out_.line("if (" + robot_ + "_topic_of(frame->id) != " + hex(slots.front().id) + "u) return " + macro_ +
                "_FOREIGN;");
      decode(slots.front(), "0");
    } else {
      out_.line("switch (" + robot_ + "_topic_of(frame->id)) {");
      for (std::size_t i = 0; i < slots.size(); ++i) {
        out_.open("case " + hex(slots[i].id) + ":");
        decode(slots[i], std::to_string(i));
        out_.undent();
      }
      out_.line("default: return " + macro_ + "_FOREIGN;");
      out_.line("}");
    }
    out_.close("}");
  }

  const Model& model_;
  const Options& options_;
  std::string robot_;
  std::string macro_;
  Writer out_;
  std::set<std::string> taken_;
  std::map<const void*, std::string> stems_;  ///< of topics and of frames
};

}  // namespace

std::string make_c(const Model& model, const Options& options) {
  return Header{model, options}.make();
}

}  // namespace ocm::generate
