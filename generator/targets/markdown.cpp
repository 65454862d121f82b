/// The reference of a robot's topics: what its spec says, for people.
#include <string_view>

#include "ocm/can/text.hpp"

#include "generator/targets/target.hpp"
#include "generator/text/messages.hpp"
#include "generator/text/words.hpp"
#include "generator/text/writer.hpp"

namespace ocm::generate {
namespace {

using base::Duration;
using spec::FieldModel;
using spec::FrameModel;
using spec::Model;
using spec::TopicModel;

/// In a table's cell.
std::string cell(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '|' || c == '<') out += '\\';
    out += c;
  }
  return out;
}

std::string code(std::string_view text) {
  return "`" + std::string{text} + "`";
}

std::string time_text(Duration duration) {
  const std::int64_t ns = duration.count();
  const auto as = [&](int exponent, const char* unit) {
    return print(base::normalised(ns, exponent)) + " " + unit;
  };
  if (ns % 1'000'000'000 == 0) return as(-9, "s");
  if (ns % 1'000'000 == 0) return as(-6, "ms");
  return ns % 1'000 == 0 ? as(-3, "us") : as(0, "ns");
}

std::string sentence(const std::string& text) {
  return text.empty() ? text : capitalised(text) + ".";
}

std::string numbers(unsigned first, unsigned count) {
  return code(hex(first)) + (count > 1 ? " to " + code(hex(first + count - 1)) : "");
}

std::string place(const FieldModel& field) {
  const protocol::Position at = field.position;
  const bool little = at.order == protocol::ByteOrder::little;
  const bool whole = at.width % 8 == 0 && at.start % 8 == (little ? 0 : 7);
  std::string text = whole ? "byte " + std::to_string(at.start / 8) : "bit " + std::to_string(at.start);
  if (whole && at.width > 8)
    text = "bytes " + std::to_string(at.start / 8) + ".." + std::to_string(at.start / 8 + at.width / 8 - 1);
  return text + (little || at.width <= 8 ? "" : ", big-endian");
}

std::string values(const FieldModel& field) {
  std::string text;
  for (const auto& value : field.values)
    text += (text.empty() ? "" : ", ") + std::string{field.flags ? "bit " : ""} + std::to_string(value.raw) +
            " " + code(value.name);
  return text;
}

class Page {
 public:
  Page(const Model& model, const Options& options) : model_(model), options_(options) {}

  std::string make() {
    out_.line("# Topics of " + model_.robot);
    out_.line();
    out_.comment("Made by `ocm-generate " + options_.spec_name +
                     " --to markdown`. Do not edit: change the spec, and generate again.",
                 "");
    out_.line();
    if (!model_.description.empty()) out_.comment(sentence(model_.description), "");
    out_.comment(std::to_string(model_.bit_rate) +
                     " bit/s. An identifier is 0x400 for what a sensor says and 0 for what a board receives, "
                     "+ 0x100 times the priority (0 urgent, 1 high, 2 medium, 3 low), + the number below. "
                     "A value is the raw number times the scale, plus the offset where there is one.",
                 "");
    contents();
    for (std::size_t i = 0; i < model_.boards.size(); ++i) board(i);
    return out_.take();
  }

 private:
  void contents() {
    out_.line();
    out_.line("| topic | alias | number | board | | asked with |");
    out_.line("|---|---|---|---|---|---|");
    for (const TopicModel& topic : model_.topics) {
      std::string aliases;
      for (const auto& alias : topic.aliases) aliases += (aliases.empty() ? "" : ", ") + alias;
      out_.line("| [" + topic.name + "](#" + topic.name + ") | " + aliases + " | " +
                numbers(topic.id, topic.count) + " | " + model_.boards[topic.board].name + " | " +
                cell(topic.description) + " | " +
                (topic.kind == protocol::Kind::sensor ? code(request(topic)) : "") + " |");
    }
  }

  /// Every default period, at the topic's priority, in candump's notation.
  static std::string request(const TopicModel& topic) {
    const protocol::Request request{protocol::TopicId{topic.id}, protocol::Mode::publish, topic.period,
                                    topic.priority};
    return std::string{can::to_text(protocol::encode(request)).view()};
  }

  void board(std::size_t index) {
    const auto& board = model_.boards[index];
    out_.line();
    out_.line("## " + board.name);
    out_.line();
    out_.comment(
        with_source(sentence(board.description) + (board.description.empty() ? "" : " ") + board.mcu + ".",
                    board.source.joined()),
        "");
    for (const TopicModel& topic : model_.topics)
      if (topic.board == index) this->topic(topic);
  }

  void topic(const TopicModel& topic) {
    const bool sensor = topic.kind == protocol::Kind::sensor;
    out_.line();
    out_.line("### " + topic.name);
    out_.line();
    if (!topic.description.empty()) out_.comment(sentence(topic.description), "");
    std::string facts = (sensor ? "Sensor " : "Actuator ") + numbers(topic.id, topic.count);
    if (topic.is_group)
      facts += ", " + code(topic.name + "_1") + " to " + code(topic.name + "_" + std::to_string(topic.count));
    facts += "; priority " + std::string{protocol::name(topic.priority)};
    if (sensor) facts += "; every " + time_text(topic.period.duration()) + " where a request names no period";
    if (topic.shortest_period.count() != 0)
      facts += "; something new every " + time_text(topic.shortest_period);
    if (topic.deadline.count() != 0) facts += "; deadline " + time_text(topic.deadline);
    if (topic.jitter.count() != 0) facts += ", jitter " + time_text(topic.jitter);
    if (topic.timeout.count() != 0) facts += "; zero when no other came for " + time_text(topic.timeout);
    out_.comment(facts + ".", "");
    for (const FrameModel& frame : topic.frames) this->frame(topic, frame);
    out_.line();
    out_.comment("Source: " + topic.source.joined() + ".", "");
  }

  void frame(const TopicModel& topic, const FrameModel& frame) {
    out_.line();
    std::string head = is_aggregate(topic) ? "Frame " + code(frame.name) + ", " : "";
    head +=
        (is_aggregate(topic) ? "number " : "Number ") + numbers(frame.id, frame.is_array ? frame.count : 1U);
    if (topic.is_group) head = "Each";
    head += ", " + std::to_string(frame.dlc) + (frame.dlc == 1 ? " byte" : " bytes");
    if (!frame.description.empty()) head += ": " + frame.description;
    out_.comment(with_source(head + ".", frame.source.joined()), "");
    if (frame.fields.empty()) return;
    out_.line();
    out_.line("| field | place | type | scale | range | |");
    out_.line("|---|---|---|---|---|---|");
    for (const FieldModel& field : frame.fields) out_.line(row(field));
  }

  static std::string row(const FieldModel& field) {
    const std::string unit = field.unit.empty() ? "" : " " + field.unit;
    std::string scale =
        field.scale == base::Decimal{1, 0} && field.unit.empty() ? "" : print(field.scale) + unit;
    if (field.offset.digits != 0) scale += ", from " + print(field.offset) + unit;
    const Range range = range_of(field);
    std::string text = sentence(field.description);
    for (const std::string& more :
         {values(field), field.source.joined().empty() ? "" : "[" + field.source.joined() + "]"})
      if (!more.empty()) text += (text.empty() ? "" : " ") + more;
    const bool named = field.flags || field.is_enumeration();
    return "| " + field.name + " | " + place(field) + " | " + (field.is_signed ? "i" : "u") +
           std::to_string(field.position.width) + " | " + cell(scale) + " | " +
           (named ? "" : print(range.low) + " to " + print(range.high) + cell(unit)) + " | " + cell(text) +
           " |";
  }

  const Model& model_;
  const Options& options_;
  Writer out_;
};

}  // namespace

std::string make_markdown(const Model& model, const Options& options) {
  return Page{model, options}.make();
}

}  // namespace ocm::generate
