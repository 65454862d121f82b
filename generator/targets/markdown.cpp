/// The reference of a robot's topics and of plain messages: what the spec says, for people.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "ocm/can/text.hpp"

#include "generator/targets/message_fields.hpp"
#include "generator/targets/target.hpp"
#include "generator/text/json.hpp"
#include "generator/text/messages.hpp"
#include "generator/text/words.hpp"
#include "generator/text/writer.hpp"

namespace ocm::generate {
namespace {

using base::Duration;
using spec::FieldModel;
using spec::FrameModel;
using spec::MessageModel;
using spec::Model;
using spec::TopicModel;

/// The shortest that reads back as the same number: as JSON has it, whose tables are here anyway; those of
/// std::to_chars would be 150 kB of amiroctl on the operator's board.
std::string shortest(double value) {
  std::string text = Json(value).line();
  if (text.ends_with(".0")) text.resize(text.size() - 2);
  return text;
}

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

/// Text of any source, which means nothing in Markdown, on one line.
std::string prose(std::string_view text) {
  const auto is_word = [](char c) {
    return static_cast<unsigned char>(c) >= 0x80 || (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') ||
           (c >= 'A' && c <= 'Z');
  };
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7F') {
      if (!out.empty() && out.back() != ' ') out += ' ';
      continue;
    }
    const bool inside = i > 0 && i + 1 < text.size() && is_word(text[i - 1]) && is_word(text[i + 1]);
    // What begins a list or a heading where a line is broken before it.
    const bool alone =
        (i == 0 || text[i - 1] == ' ') && std::string_view{"+-=>#"}.find(c) != std::string_view::npos;
    if (std::string_view{"\\`*<[]|~"}.find(c) != std::string_view::npos || (c == '_' && !inside) || alone)
      out += '\\';
    out += c;
  }
  return out;
}

/// In a table's cell, whatever it has in it.
std::string code_cell(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '|') out += '\\';
    if (static_cast<unsigned char>(c) >= ' ' && c != '\x7F') out += c;
  }
  if (out.find('`') == std::string::npos) return "`" + out + "`";
  return "`` " + out + " ``";
}

std::string joined_names(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + prose(name);
  return out;
}

/// Where a heading is found in the page. [GitHub: lower case, blanks as hyphens, no other punctuation]
class Anchors {
 public:
  std::string of(std::string_view heading) {
    std::string anchor;
    for (const char c : heading) {
      if (c >= 'A' && c <= 'Z')
        anchor += static_cast<char>(c - 'A' + 'a');
      else if (c == ' ')
        anchor += '-';
      else if (c == '-' || c == '_' || (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') ||
               static_cast<unsigned char>(c) >= 0x80)
        anchor += c;
    }
    const unsigned count = counts_[anchor]++;
    return count == 0 ? anchor : anchor + "-" + std::to_string(count);
  }

 private:
  std::map<std::string, unsigned> counts_;
};

class Page {
 public:
  Page(const Model& model, const Options& options) : model_(model), options_(options) {}

  std::string make() {
    const bool topics = !model_.topics.empty(), messages = !model_.messages.empty();
    const std::string title = (topics && messages ? "Topics and messages of "
                               : messages         ? "Messages of "
                                                  : "Topics of ") +
                              prose(model_.robot);
    anchors_.of(title);
    // The parts first: the tables of contents lead to their headings.
    for (std::size_t i = 0; i < model_.boards.size(); ++i) board(i);
    if (std::any_of(model_.messages.begin(), model_.messages.end(),
                    [&](const auto& m) { return !is_sent(m); }))
      of_no_board();
    const std::string parts = std::exchange(out_, Writer{}).take();
    out_.line("# " + title);
    out_.line();
    out_.comment("Made by `ocm-generate " + options_.spec_name +
                     " --to markdown`. Do not edit: change the spec, and generate again.",
                 "");
    out_.line();
    if (!model_.description.empty())
      out_.comment(topics ? sentence(model_.description) : ended(prose(model_.description)), "");
    if (topics)
      how_topics_are_sent();
    else if (model_.bit_rate != 0)
      out_.comment(rate() + ".", "");
    if (topics) contents();
    if (messages) message_contents();
    out_.text(parts);
    return out_.take();
  }

 private:
  [[nodiscard]] std::string rate() const {
    std::string text = std::to_string(model_.bit_rate) + " bit/s";
    if (model_.data_bit_rate != 0)
      text += ", " + std::to_string(model_.data_bit_rate) + " bit/s behind the bit-rate switch of CAN FD";
    return text;
  }

  void how_topics_are_sent() {
    out_.comment(rate() +
                     ". An identifier is 0x400 for what a sensor says and 0 for what a board receives, "
                     "+ 0x100 times the priority (0 urgent, 1 high, 2 medium, 3 low), + the number below. "
                     "A value is the raw number times the scale, plus the offset where there is one.",
                 "");
  }

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
    heading("## ", board.name);
    const bool has_topics = std::any_of(model_.topics.begin(), model_.topics.end(),
                                        [&](const auto& topic) { return topic.board == index; });
    std::string text = has_topics ? sentence(board.description) : ended(prose(board.description));
    if (!board.mcu.empty()) text += (text.empty() ? "" : " ") + board.mcu + ".";
    const bool sends = has_topics || std::any_of(model_.messages.begin(), model_.messages.end(),
                                                 [&](const auto& message) { return message.board == index; });
    if (!sends) text += std::string{text.empty() ? "" : " "} + "Sends none of them.";
    if (!text.empty()) out_.line();
    out_.comment(with_source(std::move(text), board.source.joined()), "");
    for (const TopicModel& topic : model_.topics)
      if (topic.board == index) this->topic(topic);
    for (const MessageModel& message : model_.messages)
      if (message.board == index) this->message(message);
  }

  void of_no_board() {
    heading("## ", "Of no stated sender");
    for (const MessageModel& message : model_.messages)
      if (!is_sent(message)) this->message(message);
  }
  [[nodiscard]] bool is_sent(const MessageModel& message) const {
    return message.board < model_.boards.size();
  }

  /// Gives the anchor.
  std::string heading(const char* level, const std::string& text) {
    out_.line();
    out_.line(level + prose(text));
    return anchors_.of(text);
  }

  void topic(const TopicModel& topic) {
    const bool sensor = topic.kind == protocol::Kind::sensor;
    heading("### ", topic.name);
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
    for (const spec::DerivedModel& derived : frame.derived) this->derived(frame, derived);
  }

  void derived(const FrameModel& frame, const spec::DerivedModel& derived) {
    const protocol::Law& law = derived.laws.front();
    const std::string& of = frame.fields[derived.of].name;
    std::string offsets;
    for (const protocol::Law& each : derived.laws)
      offsets += (offsets.empty() ? "" : &each == &derived.laws.back() ? " and " : ", ") + print(each.offset);
    std::string text = "Derived, on no wire: " + code(derived.name) + " in " + derived.unit + ", " +
                       print(law.min) + " to " + print(law.max) + ", the root of " + print(law.at_one) +
                       " / (" + of + " - offset)";
    if (!derived.description.empty()) text += ": " + derived.description;
    text += (derived.description.empty() || derived.description.back() != '.' ? ". " : " ");
    text += std::string{derived.laws.size() > 1 ? "Offsets " : "Offset "} + offsets + ".";
    if (law.noise.digits != 0)
      text += " " + code(derived.uncertainty_name()) + ", one standard deviation: " + derived.name + "^3 * " +
              print(law.noise) + " / " + print(*base::multiply(law.at_one, {2, 0})) + ".";
    out_.line();
    out_.comment(with_source(std::move(text), derived.source.joined()), "");
  }

  // --- plain messages ---

  static std::string ended(std::string text) {
    if (!text.empty() && std::string_view{".!?:"}.find(text.back()) == std::string_view::npos) text += '.';
    return text;
  }

  void message_contents() {
    out_.line();
    out_.line("| message | identifier | bytes | period | sender | |");
    out_.line("|---|---|---|---|---|---|");
    for (const MessageModel& message : model_.messages) {
      const auto& address = message.address;
      const std::string id = message.is_j1939() ? "group " + code(hexadecimal(group_of(address), 5))
                                                : code(hexadecimal(address.number, address.extended ? 8 : 3));
      out_.line("| [" + prose(message.name) + "](#" + places_.at(&message) + ") | " + id + " | " +
                std::to_string(message.length) + (message.fd ? ", FD" : "") + " | " +
                (message.period.count() == 0 ? "" : time_text(message.period)) + " | " +
                (is_sent(message) ? prose(model_.boards[message.board].name) : "") + " | " +
                prose(message.description) + " |");
    }
  }

  void message(const MessageModel& message) {
    places_.emplace(&message, heading("### ", message.name));
    out_.line();
    if (!message.description.empty()) out_.comment(ended(prose(message.description)), "");
    std::string facts = capitalised(address_text(message));
    if (!message.send_type.empty()) facts += " Sent as " + prose(message.send_type) + ".";
    if (message.shortest_period.count() != 0)
      facts += " At least " + time_text(message.shortest_period) + " apart.";
    if (message.deadline.count() != 0) facts += " Deadline " + time_text(message.deadline) + ".";
    if (message.jitter.count() != 0) facts += " Jitter " + time_text(message.jitter) + ".";
    if (!message.other_senders.empty()) facts += " Also sent by " + joined_names(message.other_senders) + ".";
    if (!message.aliases.empty()) facts += " Also called " + joined_names(message.aliases) + ".";
    out_.comment(facts, "");
    if (!message.fields.empty()) {
      out_.line();
      out_.line("| field | place | type | scale | range | |");
      out_.line("|---|---|---|---|---|---|");
      for (const FieldModel& field : message.fields) out_.line(message_row(message, field));
    }
    if (message.source.joined().empty()) return;
    out_.line();
    out_.comment("Source: " + prose(message.source.joined()) + ".", "");
  }

  static std::string selection(const FieldModel& field) {
    std::string text;
    for (const auto& [first, last] : field.selected)
      text += (text.empty() ? "" : ", ") + std::to_string(first) +
              (first == last ? "" : " to " + std::to_string(last));
    return "Where " + code_cell(field.selector) + " is " + text + ".";
  }

  static std::string range_text(const FieldModel& field) {
    const std::string unit = field.unit.empty() ? "" : " " + prose(field.unit);
    if (field.range) return print(field.range->min) + " to " + print(field.range->max) + unit;
    const auto width = field.position.width;
    if (field.number != protocol::Number::integer || (width == 64 && !field.is_signed)) return {};
    auto low = exact_physical(field, protocol::lowest(width, field.is_signed));
    auto high = exact_physical(field, protocol::highest(width, field.is_signed));
    if (!low || !high) return {};
    if (field.scale.digits < 0) std::swap(low, high);
    return print(*low) + " to " + print(*high) + unit;
  }

  static std::string start_text(const FieldModel& field) {
    if (field.start.value_or(0) == 0) return {};
    std::string text;
    if (field.number == protocol::Number::integer) {
      const auto value = exact_physical(field, *field.start);
      if (!value || (field.position.width == 64 && !field.is_signed && *field.start < 0)) return {};
      text = print(*value);
    } else {
      const double raw =
          field.number == protocol::Number::float32
              ? static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(*field.start)))
              : std::bit_cast<double>(*field.start);
      const double value = raw * field.scale.as_double() + field.offset.as_double();
      if (!std::isfinite(value)) return {};
      text = shortest(value);
    }
    return "Starts at " + text + (field.unit.empty() ? "" : " " + prose(field.unit)) + ".";
  }

  static std::string message_row(const MessageModel& message, const FieldModel& field) {
    const std::string unit = field.unit.empty() ? "" : " " + prose(field.unit);
    const bool plain = field.scale == base::Decimal{1, 0} && unit.empty() && field.offset.digits == 0;
    std::string scale = plain ? "" : print(field.scale) + unit;
    if (field.offset.digits != 0) scale += ", from " + print(field.offset) + unit;
    std::string named;
    for (const auto& value : field.values)
      named += (named.empty() ? "" : ", ") + std::string{field.flags ? "bit " : ""} +
               field.raw_text(value.raw) + " " + code_cell(value.name);
    if (!named.empty()) named += ".";
    std::string text;
    for (const std::string& more :
         {field.selector.empty() ? "" : selection(field), ended(prose(field.description)), named,
          start_text(field), field.receivers.empty() ? "" : "To " + joined_names(field.receivers) + ".",
          field.position.bytes() > message.length ? std::string{"Beyond the length: in longer frames only."}
                                                  : "",
          field.source.joined().empty() ? "" : prose("[" + field.source.joined() + "]")})
      if (!more.empty()) text += (text.empty() ? "" : " ") + more;
    const char* const kind = field.number != protocol::Number::integer ? "f" : field.is_signed ? "i" : "u";
    const bool is_named = field.flags || field.is_enumeration();
    return "| " + prose(field.name) + " | " + place(field) + " | " + kind +
           std::to_string(field.position.width) + " | " + scale + " | " +
           (is_named ? "" : range_text(field)) + " | " + text + " |";
  }

  // --- topics ---

  static std::string row(const FieldModel& field) {
    const std::string unit = field.unit.empty() ? "" : " " + field.unit;
    const bool plain = field.scale == base::Decimal{1, 0} && field.unit.empty() && field.offset.digits == 0;
    std::string scale = plain ? "" : print(field.scale) + unit;
    if (field.offset.digits != 0) scale += ", from " + print(field.offset) + unit;
    const Range range = range_of(field);
    std::string text = sentence(field.description);
    for (const std::string& more :
         {values(field), field.source.joined().empty() ? "" : "[" + field.source.joined() + "]"})
      if (!more.empty()) text += (text.empty() ? "" : " ") + more;
    const bool named = field.flags || field.is_enumeration();
    const bool is_float = field.number != protocol::Number::integer;
    return "| " + field.name + " | " + place(field) + " | " +
           (is_float          ? "f"
            : field.is_signed ? "i"
                              : "u") +
           std::to_string(field.position.width) + " | " + cell(scale) + " | " +
           (named || (is_float && !field.range)
                ? ""
                : print(range.low) + " to " + print(range.high) + cell(unit)) +
           " | " + cell(text) + " |";
  }

  const Model& model_;
  const Options& options_;
  Writer out_;
  Anchors anchors_;
  std::map<const MessageModel*, std::string> places_;  ///< the anchors of messages
};

}  // namespace

std::string make_markdown(const Model& model, const Options& options) {
  return Page{model, options}.make();
}

}  // namespace ocm::generate
