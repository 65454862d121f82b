/// A CAN database in Vector's DBC format, for tools that know neither requests nor priorities. A topic whose
/// priority is changed moves to another identifier, so each frame is there once a priority, as
/// Gyroscope_high; and each sensor's request beside its samples, as GyroscopeRequest_high.
///
/// Plain messages are there as they are (dbc_messages.hpp).
///
/// There is no public standard of the format; what is written here is read alike by canmatrix, cantools and
/// our own reader.
#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "ocm/base/utf8.hpp"

#include "generator/dbc/encoding.hpp"
#include "generator/spec/names.hpp"
#include "generator/targets/dbc_messages.hpp"
#include "generator/targets/dbc_names.hpp"
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

/// A character that Windows-1252 has not becomes a question mark: a topic's text must not make the whole file
/// UTF-8, which few programs expect.
std::string legible(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    std::size_t length = 1;
    while (i + length < text.size() && base::continues_character(text[i + length])) ++length;
    const std::string_view character = text.substr(i, length);
    out += dbc::has_cp1252(character) ? character : std::string_view{"?"};
    i += length;
  }
  return out;
}

/// A text within quotes. Readers disagree on how to escape one, so that there is none.
std::string text_of(std::string text) {
  std::replace(text.begin(), text.end(), '"', '\'');
  return '"' + legible(text) + '"';
}

std::string sentence(std::string_view text) {
  return text.empty() ? std::string{} : capitalised(std::string{text}) + ". ";
}

/// The sections of a database are by kind, and not by message.
class Dbc {
 public:
  Dbc(const Model& model, const Options& options) : model_(model), options_(options) {
    for (const auto& board : model.boards) node_names_.expect(board.name);
    for (const auto& message : model.messages) message_names_.expect(message.name);
    for (const auto& board : model.boards) nodes_.push_back(node(board.name));
  }

  std::string make() {
    for (const Priority priority : priorities) {
      if (options_.priority && *options_.priority != priority) continue;
      for (const TopicModel& topic : model_.topics)
        if (topic.kind == protocol::Kind::sensor) request(topic, priority);
      for (const Message& each : messages(model_)) message(each, priority);
    }
    define();
    DbcParts parts = dbc_messages(model_, nodes_, message_names_, defined_);
    return dbc_bytes(head() + messages_ + parts.messages + "\n" + parts.senders + comments() +
                     parts.comments + definitions_ + parts.definitions + defaults_ + parts.defaults +
                     attributes_ + parts.attributes + values_ + parts.values + numbers_ + parts.numbers +
                     parts.selectors);
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
    DbcNames signal_names;
    for (const FieldModel& field : message.frame->fields)
      signal(message, field, id, signal_names, sensor ? operator_node : board);
    if (sensor && priority == topic.priority)
      attributes_ += "BA_ \"GenMsgCycleTime\" BO_ " + id + " " + milliseconds(topic) + ";\n";
  }

  void signal(const Message& message, const FieldModel& field, const std::string& id, DbcNames& names,
              std::string_view receiver) {
    const std::string name = names.unique(field.name);
    if (name != field.name) long_symbol("SystemSignalLongSymbol", "SG_ " + id + " " + name, field.name);
    const protocol::Position at = field.position;
    const Range range = range_of(field);
    messages_ += " SG_ " + name + " : " + std::to_string(at.start) + "|" + std::to_string(at.width) + "@" +
                 (at.order == protocol::ByteOrder::little ? "1" : "0") +
                 (field.is_signed || field.number != protocol::Number::integer ? "-" : "+") + " (" +
                 print(field.scale) + "," + print(field.offset) + ") [" + print(range.low) + "|" +
                 print(range.high) + "] " + text_of(field.unit) + " " + std::string{receiver} + "\n";
    if (field.number != protocol::Number::integer)
      numbers_ += "SIG_VALTYPE_ " + id + " " + name + " : " +
                  (field.number == protocol::Number::float32 ? "1" : "2") + ";\n";
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
    std::string text = "VERSION \"\"\n\nNS_ :\n\nBS_:\n\nBU_:";
    if (has_topics()) text.append(" ").append(operator_node);
    for (const auto& name : nodes_) text += " " + name;
    return text + "\n";
  }

  std::string comments() const {
    std::string text;
    if (has_topics())
      text = "CM_ " +
             text_of(
                 "Made by ocm-generate from " + options_.spec_name + ": the topics of " + model_.robot +
                 (model_.description.empty() ? "" : ", " + model_.description) +
                 ". Identifiers: bit 10 is 0 for requests and set points, 1 for samples; bits 9 to 8 are the "
                 "priority, 0 the most urgent; bits 7 to 0 the topic.") +
             ";\n";
    else if (!model_.description.empty())
      text = "CM_ " + dbc_text(model_.description) + ";\n";
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const auto& board = model_.boards[i];
      if (!board.mcu.empty())
        text += "CM_ BU_ " + nodes_[i] + " " +
                text_of(sentence(board.description) + board.mcu + ". [" + board.source.joined() + "]") +
                ";\n";
      else if (!board.description.empty())
        text += "CM_ BU_ " + nodes_[i] + " " + dbc_text(board.description) + ";\n";
    }
    return text + comments_;
  }

  // --- what the attributes are ---

  /// `of` is the kind of object with a blank behind it, or nothing for the whole bus.
  void define(const std::string& of, const std::string& name, const std::string& type,
              const std::string& value) {
    definitions_ += "BA_DEF_ " + of + "\"" + name + "\" " + type + ";\n";
    defaults_ += "BA_DEF_DEF_ \"" + name + "\" " + value + ";\n";
    defined_.insert(of + name);
  }
  void define() {
    std::string bus;
    const auto of_bus = [&](const char* name, const char* type, const char* usual, const std::string& value) {
      const auto& attributes = model_.attributes;  // those of a DBC file are written with its others
      if (std::any_of(attributes.begin(), attributes.end(),
                      [&](const auto& each) { return each.name == name; }))
        return;
      const auto& known = model_.definitions;  // whose default says it
      if (std::any_of(known.begin(), known.end(), [&](const auto& each) {
            return each.of == spec::AttributeDefinitionModel::Of::bus && each.name == name &&
                   each.default_text == value;
          }))
        return;
      define("", name, type, usual);
      bus += "BA_ \"" + std::string{name} + "\" " + value + ";\n";
    };
    if (has_topics()) of_bus("BusType", "STRING ", "\"CAN\"", "\"CAN\"");
    if (model_.bit_rate != 0)
      of_bus("Baudrate", "INT 1000 1000000", "500000", std::to_string(model_.bit_rate));
    if (model_.data_bit_rate != 0)
      of_bus("BaudrateCANFD", "INT 1000 16000000", "2000000", std::to_string(model_.data_bit_rate));
    attributes_ = bus + attributes_;
    // A period need not be a whole number of milliseconds.
    const auto is_whole = [](base::Duration period) { return period.count() % 1'000'000 == 0; };
    const bool whole =
        std::all_of(model_.topics.begin(), model_.topics.end(),
                    [&](const TopicModel& topic) { return is_whole(topic.period.duration()); }) &&
        std::all_of(model_.messages.begin(), model_.messages.end(),
                    [&](const spec::MessageModel& message) { return is_whole(message.period); });
    if (has_topics()) define("BO_ ", "GenMsgCycleTime", whole ? "INT 0 65535000" : "FLOAT 0 65535000", "0");
    if (!has_long_names_) return;
    define("BU_ ", "SystemNodeLongSymbol", "STRING ", "\"\"");
    define("BO_ ", "SystemMessageLongSymbol", "STRING ", "\"\"");
    define("SG_ ", "SystemSignalLongSymbol", "STRING ", "\"\"");
  }
  [[nodiscard]] bool has_topics() const { return !model_.topics.empty(); }

  const Model& model_;
  const Options& options_;
  DbcNames node_names_;
  DbcNames message_names_;
  std::vector<std::string> nodes_;  ///< by the board's index
  std::string messages_;
  std::string comments_;
  std::string definitions_;
  std::string defaults_;
  std::set<std::string> defined_;  ///< kinds of objects and names of attributes
  std::string attributes_;
  std::string values_;
  std::string numbers_;  ///< which signals are floats
  bool has_long_names_ = false;
};

}  // namespace

std::string make_dbc(const Model& model, const Options& options) {
  return Dbc{model, options}.make();
}

}  // namespace ocm::generate
