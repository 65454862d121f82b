/// A CAN database in Vector's DBC format, for tools that know neither requests nor priorities. A topic whose
/// priority is changed moves to another identifier, so each frame is there once a priority, as
/// Gyroscope_high; and each sensor's request beside its samples, as GyroscopeRequest_high.
///
/// There is no public standard of the format; what is written here is read alike by canmatrix, cantools and
/// the `analyse` verb. Text is Latin-1, as those expect. No field is a floating-point number, so there is no
/// SIG_VALTYPE_.
#include <algorithm>
#include <set>
#include <vector>

#include "generator/spec/names.hpp"
#include "generator/targets/target.hpp"
#include "generator/text/messages.hpp"
#include "generator/text/words.hpp"

namespace ocm::generate {
namespace {

using protocol::Priority;
using spec::FieldModel;
using spec::Model;
using spec::TopicModel;

/// The bus's other end, which asks and commands. No board can have this name, for it is a word of C++.
constexpr std::string_view operator_node = "operator";

/// Names of at most 32 characters, as the format has them; each is given out once.
class Names {
 public:
  static constexpr std::size_t longest = 32;

  std::string unique(const std::string& full, const std::string& suffix = {}) {
    for (unsigned number = 1;; ++number) {
      const std::string tail = (number == 1 ? "" : "_" + std::to_string(number)) + suffix;
      std::string name = full.substr(0, longest - tail.size()) + tail;
      if (taken_.insert(name).second) return name;
    }
  }

 private:
  std::set<std::string> taken_;
};

/// What the format can say of UTF-8: U+0080 to U+00FF as one byte, others as a question mark.
std::string latin_1(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = static_cast<unsigned char>(text[i++]);
    if (byte < 0x80) {
      out += text[i - 1];
      continue;
    }
    unsigned continued = 0;
    unsigned last = 0;
    for (; i < text.size() && (static_cast<unsigned char>(text[i]) & 0xC0) == 0x80; ++i, ++continued)
      last = static_cast<unsigned char>(text[i]) & 0x3FU;
    const bool fits = continued == 1 && (byte == 0xC2 || byte == 0xC3);
    out += fits ? static_cast<char>((byte & 0x03U) << 6 | last) : '?';
  }
  return out;
}

/// A text within quotes. Readers disagree on how to escape one, so that there is none.
std::string text_of(std::string text) {
  std::replace(text.begin(), text.end(), '"', '\'');
  return '"' + latin_1(text) + '"';
}

std::string sentence(std::string_view text) {
  return text.empty() ? std::string{} : capitalised(std::string{text}) + ". ";
}

/// The sections of a database are by kind, and not by message.
class Dbc {
 public:
  Dbc(const Model& model, const Options& options) : model_(model), options_(options) {
    for (const auto& board : model.boards) nodes_.push_back(node(board.name));
  }

  std::string make() {
    for (const Priority priority : priorities) {
      if (options_.priority && *options_.priority != priority) continue;
      for (const TopicModel& topic : model_.topics)
        if (topic.kind == protocol::Kind::sensor) request(topic, priority);
      for (const Message& each : messages(model_)) message(each, priority);
    }
    return head() + messages_ + "\n" + comments() + definitions() + attributes_ + values_;
  }

 private:
  std::string node(const std::string& full) {
    std::string name = node_names_.unique(full);
    if (name != full) long_symbol("SystemNodeLongSymbol", "BU_ " + name, full);
    return name;
  }

  void long_symbol(std::string_view attribute, const std::string& object, const std::string& full) {
    attributes_ += "BA_ \"" + std::string{attribute} + "\" " + object + " \"" + full + "\";\n";
    has_long_names_ = true;
  }

  /// The first line of a message. Returns its identifier as a text.
  std::string begin(const std::string& stem, Priority priority, std::uint16_t identifier, unsigned dlc,
                    std::string_view sender, const std::string& comment) {
    const std::string suffix = options_.priority ? "" : "_" + std::string{protocol::name(priority)};
    const std::string name = message_names_.unique(stem, suffix);
    const std::string id = std::to_string(identifier);
    messages_ += "\nBO_ " + id + " " + name + ": " + std::to_string(dlc) + " " + std::string{sender} + "\n";
    if (name != stem + suffix) long_symbol("SystemMessageLongSymbol", "BO_ " + id, stem + suffix);
    comments_ += "CM_ BO_ " + id + " " + text_of(comment) + ";\n";
    return id;
  }

  void message(const Message& message, Priority priority) {
    const TopicModel& topic = *message.topic;
    const std::string& board = nodes_[topic.board];
    const bool sensor = message.is_sensor();
    std::string comment = title(message.topic_name) +
                          (message.frame_name.empty() ? "" : ", " + message.frame_name) + ". " +
                          sentence(topic.description) + sentence(message.frame->description);
    if (!sensor && topic.timeout.count() != 0)
      comment += "Without another within " + print(base::normalised(topic.timeout.count(), -9)) +
                 " s the board takes zero. ";
    const std::string own = message.frame->source.joined();
    comment += "[" + (own.empty() ? topic.source.joined() : own) + "]";
    const std::string id = begin(
        spec::pascal_case(message.topic_name) + spec::pascal_case(message.frame_name), priority,
        message.identifier(priority), message.frame->dlc, sensor ? board : operator_node, std::move(comment));
    Names signal_names;
    for (const FieldModel& field : message.frame->fields)
      signal(message, field, id, signal_names, sensor ? operator_node : board);
    if (sensor && priority == topic.priority)
      attributes_ += "BA_ \"GenMsgCycleTime\" BO_ " + id + " " + milliseconds(topic) + ";\n";
  }

  void signal(const Message& message, const FieldModel& field, const std::string& id, Names& names,
              std::string_view receiver) {
    const std::string name = names.unique(field.name);
    if (name != field.name) long_symbol("SystemSignalLongSymbol", "SG_ " + id + " " + name, field.name);
    const protocol::Position at = field.position;
    const Range range = range_of(field);
    messages_ += " SG_ " + name + " : " + std::to_string(at.start) + "|" + std::to_string(at.width) + "@" +
                 (at.order == protocol::ByteOrder::little ? "1" : "0") + (field.is_signed ? "-" : "+") +
                 " (" + print(field.scale) + "," + print(field.offset) + ") [" + print(range.low) + "|" +
                 print(range.high) + "] " + text_of(field.unit) + " " + std::string{receiver} + "\n";
    std::string comment = sentence(field.description);
    if (field.flags)
      for (const auto& flag : field.values)
        comment += "Bit " + std::to_string(flag.raw) + ": " + flag.name + ". ";
    if (const std::string& source = field.source.joined(); !source.empty() || !comment.empty())
      comments_ += "CM_ SG_ " + id + " " + name + " " +
                   text_of(comment + "[" + source_of(message, field) + "]") + ";\n";
    if (field.flags || field.values.empty()) return;
    values_ += "VAL_ " + id + " " + name;
    for (const auto& value : field.values)
      values_ += " " + std::to_string(value.raw) + " " + text_of(value.name);
    values_ += " ;\n";
  }

  void request(const TopicModel& topic, Priority priority) {
    const std::string id = begin(
        spec::pascal_case(topic.name) + "Request", priority, request_identifier(topic, priority), 4,
        operator_node,
        "Asks " + model_.boards[topic.board].name + " for " + title(topic.name) +
            ". Stop and once are one byte long, and so is a publish that leaves the period to the board.");
    const auto line = [&](std::string_view signal, std::string_view place, std::string_view range) {
      messages_.append(" SG_ ")
          .append(signal)
          .append(" : ")
          .append(place)
          .append("@1+ (1,0) [")
          .append(range);
      messages_.append("] \"\" ").append(nodes_[topic.board]) += "\n";
    };
    line("mode M", "0|8", "0|2");
    line("period m1", "8|16", "1|65535");
    line("unit m1", "24|8", "0|2");
    comments_ += "CM_ SG_ " + id + " period \"In the unit of the signal unit.\";\n";
    const auto values = [&](std::string_view signal, const auto& names) {
      values_.append("VAL_ ").append(id).append(" ").append(signal);
      std::size_t number = 0;
      for (const std::string_view name : names)
        values_ += " " + std::to_string(number++) + " " + text_of(std::string{name});
      values_ += " ;\n";
    };
    values("mode", mode_names);
    values("unit", unit_names);
  }

  static std::string milliseconds(const TopicModel& topic) {
    return print(base::normalised(topic.period.duration().count(), -6));
  }

  std::string head() const {
    std::string text = "VERSION \"\"\n\nNS_ :\n\nBS_:\n\nBU_: " + std::string{operator_node};
    for (const auto& name : nodes_) text += " " + name;
    return text + "\n";
  }

  std::string comments() const {
    std::string text =
        "CM_ " +
        text_of("Made by ocm-generate from " + options_.spec_name + ": the topics of " + model_.robot +
                (model_.description.empty() ? "" : ", " + model_.description) +
                ". Identifiers: bit 10 is 0 for requests and set points, 1 for samples; bits 9 to 8 are the "
                "priority, 0 the most urgent; bits 7 to 0 the topic.") +
        ";\n";
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const auto& board = model_.boards[i];
      text += "CM_ BU_ " + nodes_[i] + " " +
              text_of(sentence(board.description) + board.mcu + ". [" + board.source.joined() + "]") + ";\n";
    }
    return text + comments_;
  }

  /// What the attributes are: a period need not be a whole number of milliseconds.
  std::string definitions() const {
    const bool whole = std::all_of(model_.topics.begin(), model_.topics.end(), [](const TopicModel& topic) {
      return topic.period.duration().count() % 1'000'000 == 0;
    });
    std::string text = "BA_DEF_ \"BusType\" STRING ;\nBA_DEF_ \"Baudrate\" INT 1000 1000000;\n";
    text += std::string{"BA_DEF_ BO_ \"GenMsgCycleTime\" "} + (whole ? "INT" : "FLOAT") + " 0 65535000;\n";
    std::string defaults =
        "BA_DEF_DEF_ \"BusType\" \"CAN\";\nBA_DEF_DEF_ \"Baudrate\" 500000;\n"
        "BA_DEF_DEF_ \"GenMsgCycleTime\" 0;\n";
    if (has_long_names_) {
      text +=
          "BA_DEF_ BU_ \"SystemNodeLongSymbol\" STRING ;\n"
          "BA_DEF_ BO_ \"SystemMessageLongSymbol\" STRING ;\n"
          "BA_DEF_ SG_ \"SystemSignalLongSymbol\" STRING ;\n";
      for (const char* of : {"Node", "Message", "Signal"})
        defaults += std::string{"BA_DEF_DEF_ \"System"} + of + "LongSymbol\" \"\";\n";
    }
    return text + defaults + "BA_ \"BusType\" \"CAN\";\nBA_ \"Baudrate\" " + std::to_string(model_.bit_rate) +
           ";\n";
  }

  const Model& model_;
  const Options& options_;
  Names node_names_;
  Names message_names_;
  std::vector<std::string> nodes_;  ///< by the board's index
  std::string messages_;
  std::string comments_;
  std::string attributes_;
  std::string values_;
  bool has_long_names_ = false;
};

}  // namespace

std::string make_dbc(const Model& model, const Options& options) {
  return Dbc{model, options}.make();
}

}  // namespace ocm::generate
