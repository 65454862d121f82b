/// A person's view: one line a sample, with time since the first frame, priority, topic, and the values with
/// their units in columns. Samples of several frames appear when they are complete.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "ocm/base/utf8.hpp"
#include "ocm/can/error_frame.hpp"
#include "ocm/can/text.hpp"
#include "ocm/client/counted.hpp"
#include "ocm/j1939/identifier.hpp"
#include "ocm/protocol/request.hpp"

#include "cli/output/field_text.hpp"
#include "cli/output/named_value.hpp"
#include "cli/output/output.hpp"
#include "cli/shared/folding.hpp"
#include "cli/words/quantity.hpp"

namespace ocm::cli {
namespace {

constexpr std::string_view plain = "\033[0m";
constexpr std::string_view dim = "\033[2m";
constexpr std::string_view bold = "\033[1m";
constexpr std::string_view red = "\033[31m";

/// What is printed before and after a value, and how wide it may become.
struct Column {
  FieldText value;
  std::size_t frame = 0;
  std::string before;  ///< label
  std::string unit;    ///< with a blank before it; empty where none is shown
  bool unit_of_all = false;
  std::size_t width = 0;
  bool varies = false;            ///< not every frame has it
  std::string_view apart = "  ";  ///< behind another one
};

class Pretty final : public Output {
 public:
  Pretty(const protocol::Catalogue& catalogue, const Selection& selection, bool colour, Columns columns)
      : colour_(colour), everything_(selection.everything()), terminal_columns_(columns) {
    for (const auto& topic : catalogue.topics) name_width_ = std::max(name_width_, base::columns(topic.name));
    for (const auto& topic : catalogue.topics) {
      const std::string name = painted(bold, fmt::format("{:<{}}  ", topic.name, name_width_));
      const std::string narrow = painted(bold, topic.name) + "  ";
      topics_.emplace(&topic, TopicText{name, narrow, columns_of(topic, selection)});
    }
    constexpr std::array<std::string_view, 4> codes{"\033[31m", "\033[33m", "\033[32m", "\033[36m"};
    for (std::size_t i = 0; i < codes.size(); ++i)
      priorities_[i] =
          painted(codes[i], fmt::format("{:<7} ", protocol::name(static_cast<protocol::Priority>(i))));
  }

  bool write(Buffer& out, const Event& event) override {
    using client::Meaning;
    const Meaning meaning = event.reception.meaning;
    if (meaning == Meaning::part || meaning == Meaning::transport) return false;
    const bool data = meaning == Meaning::sample || meaning == Meaning::set_point;
    if (!everything_ && !(data && has_chosen(event))) return false;
    width_ = terminal_columns_ == nullptr ? SIZE_MAX : terminal_columns_();
    const std::size_t begin = out.size();
    breaks_.clear();
    write_line(out, event);
    if (width_ != SIZE_MAX) fit(out, begin);
    out.append('\n');
    return true;
  }

 private:
  struct TopicText {
    std::string name;    ///< as wide as the longest
    std::string narrow;  ///< as wide as it is
    std::vector<Column> columns;
  };

  static constexpr std::size_t before_name = 22;  ///< columns of time and priority
  /// Columns beside the names: with less than this, names take no column of their own.
  static constexpr std::size_t value_room = 40;

  /// Whether a sample or set point has a field that was chosen.
  [[nodiscard]] bool has_chosen(const Event& event) const {
    const auto& topic = *event.reception.topic;
    const auto& columns = topics_.at(&topic).columns;
    return std::any_of(columns.begin(), columns.end(), [&](const Column& column) {
      return !column.varies || topic.frames[column.frame].has(column.value.field(), bytes_of(event));
    });
  }

  [[nodiscard]] bool has_column_of_names() const {
    return width_ == SIZE_MAX || before_name + name_width_ + value_room <= width_;
  }

  /// The line that begins at `begin` may go on in another one from here.
  void may_break(const Buffer& out) {
    if (width_ != SIZE_MAX) breaks_.push_back(out.size());
  }

  /// The last line of `out` as several, if the terminal has not the room for it.
  void fit(Buffer& out, std::size_t begin) {
    const std::string line{out.view().substr(begin)};
    if (extent(line).words <= width_) return;
    Folding folding{width_, has_column_of_names() ? before_name : 4};
    std::size_t at = 0;
    breaks_.push_back(out.size());
    for (const std::size_t end : breaks_) {
      folding.add(std::string_view{line}.substr(at, end - begin - at));
      at = end - begin;
    }
    out.cut(begin);
    out.append(folding.text());
  }

  void write_line(Buffer& out, const Event& event) {
    using client::Meaning;
    switch (event.reception.meaning) {
      case Meaning::part:
      case Meaning::transport:
        break;
      case Meaning::sample:
        head(out, event, "");
        values(out, *event.reception.topic,
               [&](std::size_t frame) { return event.reception.sample.data(frame); });
        break;
      case Meaning::set_point: {
        head(out, event, "<- ");
        values(out, *event.reception.topic, [&](std::size_t) { return event.entry.bytes(); });
        break;
      }
      case Meaning::request:
        head(out, event, "<- ");
        request(out, *event.reception.topic, *event.entry.classic());
        break;
      case Meaning::wrong_dlc:
        head(out, event, "");
        out.append(painted(
            red, fmt::format("{} instead of {}: {}",
                             event.reception.topic->is_message() ? client::counted(event.entry.length, "byte")
                                                                 : fmt::format("DLC {}", event.entry.length),
                             event.reception.frame.layout().length, frame_text(event.entry))));
        break;
      case Meaning::remote:
        head(out, event, "");
        append_formatted(out, "remote frame: {}", frame_text(event.entry));
        break;
      case Meaning::unknown:
        time(out, event);
        if (const auto* const message = event.reception.transported) {
          append_formatted(out, "{} unknown group {:05X}:", route_of(message->id), message->id.pgn);
          for (const std::uint8_t byte : message->data) append_formatted(out, " {:02X}", byte);
          break;
        }
        append_formatted(out, "{:<7} {}: {}", "-", event.entry.is_fd() ? "CAN FD" : "unknown",
                         frame_text(event.entry));
        break;
      case Meaning::error:
        time(out, event);
        out.append(painted(
            red, fmt::format("{:<7} error frame: {}", "-", can::describe(*event.entry.classic()).view())));
        break;
    }
  }

  [[nodiscard]] std::string painted(std::string_view code, std::string_view text) const {
    return colour_ ? fmt::format("{}{}{}", code, text, plain) : std::string{text};
  }

  /// In candump's notation.
  static std::string frame_text(const log::Entry& entry) {
    if (const auto frame = entry.classic()) return std::string{can::to_text(*frame).view()};
    const bool wide = can::is_extended(entry.format);
    std::string text =
        fmt::format("{:0{}X}##{:X}", entry.id, wide ? 8 : 3, entry.flags & 0xFU & ~unsigned{log::flag::fd});
    for (const std::uint8_t byte : entry.bytes()) text += fmt::format("{:02X}", byte);
    return text;
  }

  /// Seconds since the first frame, with microseconds.
  void time(Buffer& out, const Event& event) {
    if (!started_) begin_ = event.entry.time;
    started_ = true;
    // Two times can be further apart than a signed number counts.
    const auto begin = static_cast<std::uint64_t>(begin_.time_since_epoch().count());
    const auto at = static_cast<std::uint64_t>(event.entry.time.time_since_epoch().count());
    const bool before = event.entry.time < begin_;
    const std::uint64_t magnitude = (before ? begin - at : at - begin) / 1000;
    char text[64];
    char* to = text;
    if (colour_) to = std::copy(dim.begin(), dim.end(), to);
    *to = '-';
    to += before && magnitude != 0 ? 1 : 0;
    const std::uint64_t seconds = magnitude / 1'000'000;
    for (std::uint64_t least = 10'000; least > 1 && seconds < least; least /= 10) *to++ = ' ';
    to = put_unsigned(to, seconds);
    put_eight(to, magnitude % 1'000'000);  // eight digits, of which the first two give way to the point
    std::memmove(to + 1, to + 2, 6);
    *to = '.';
    to += 7;
    *to++ = ' ';
    *to++ = ' ';
    if (colour_) to = std::copy(plain.begin(), plain.end(), to);
    out.append({text, static_cast<std::size_t>(to - text)});
    may_break(out);
  }

  void head(Buffer& out, const Event& event, std::string_view arrow) {
    time(out, event);
    out.append(priority_of(event));
    may_break(out);
    const TopicText& topic = topics_.at(event.reception.topic);
    out.append(has_column_of_names() ? topic.name : topic.narrow);
    may_break(out);
    out.append(arrow);
  }

  /// Priority, source and destination.
  static std::string route_of(const j1939::Identifier& id) {
    return fmt::format("{} {:02X}>{:02X}", id.priority, id.source, id.destination);
  }

  /// A topic's in words; of a message its identifier, or by J1939 the priority, source and destination in it.
  [[nodiscard]] std::string priority_of(const Event& event) const {
    const auto& topic = *event.reception.topic;
    if (!topic.is_message())
      return priorities_[static_cast<std::size_t>(protocol::Identifier::decode(event.entry.id).priority)];
    if (topic.frames[0].address.by != protocol::Address::By::pgn)
      return painted(dim, fmt::format("{:>7} ", fmt::format("{:0{}X}", event.entry.id,
                                                            can::is_extended(event.entry.format) ? 8 : 3)));
    const auto* const message = event.reception.transported;
    return painted(
        dim, route_of(message != nullptr ? message->id : j1939::Identifier::decode(event.entry.id)) + ' ');
  }

  [[nodiscard]] std::vector<Column> columns_of(const protocol::Topic& topic,
                                               const Selection& selection) const {
    std::vector<Column> columns;
    for (std::size_t i = 0; i < topic.frames.size(); ++i) {
      const auto& layout = topic.frames[i];
      for (const auto& field : layout.values()) {
        if (!selection.has(layout, field)) continue;
        if (field.uncertainty && !columns.empty() && columns.back().value.field().law == field.law) {
          // Beside its value: 0.0482 +-0.0003 m.
          columns.push_back({FieldText{field}, i, " +-", std::move(columns.back().unit), false, 0, true, ""});
          columns[columns.size() - 2].unit.clear();
          continue;
        }
        std::string label{field.name};
        if (topic.frames.size() > 1 && !(field.is_derived() && selection.everything())) {
          label = layout.name;
          if (layout.fields.size() > 1 || field.is_derived()) label.append(".").append(field.name);
        }
        std::string before = painted(dim, label) + ' ';
        std::string unit = field.unit.empty() ? std::string{} : ' ' + std::string{field.unit};
        columns.push_back({FieldText{field}, i, std::move(before), std::move(unit), false, width_of(field),
                           layout.may_lack(field)});
      }
    }
    // One unit for all comes at the end.
    const bool one_unit = std::all_of(columns.begin(), columns.end(),
                                      [&](const Column& column) { return column.unit == columns[0].unit; });
    for (auto& column : columns) {
      column.unit_of_all = one_unit;
      if (one_unit && &column != &columns.back()) column.unit.clear();
    }
    return columns;
  }

  static std::size_t width_of(const protocol::Field& field) {
    std::size_t width = 1;
    for (const std::int64_t raw : {field.raw_min, field.raw_max})
      if (const auto bound = field.physical(raw))
        width = std::max(width, base::to_text(*bound).view().size());
    // A whole bound says nothing of the digits behind the point.
    if (field.scale.exponent < 0) width = std::max(width, static_cast<std::size_t>(2 - field.scale.exponent));
    return std::min<std::size_t>(width, 11);
  }

  static void put_right(Buffer& out, std::string_view text, std::size_t width) {
    if (const std::size_t size = base::columns(text); size < width) {
      std::memset(out.room(width - size), ' ', width - size);
      out.grow(width - size);
    }
    out.append(text);
  }

  /// `data_of` a frame of the topic: its bytes.
  template <class DataOf>
  void values(Buffer& out, const protocol::Topic& topic, DataOf data_of) {
    bool first = true;
    for (const Column& column : topics_.at(&topic).columns) {
      const std::span<const std::uint8_t> bytes = data_of(column.frame);
      const std::uint8_t* const data = bytes.data();
      const auto& field = column.value.field();
      if (column.varies && !topic.frames[column.frame].has(field, bytes)) continue;
      may_break(out);
      if (!std::exchange(first, false)) out.append(column.apart);
      out.append(column.before);
      char number[FieldText::room];
      bool named = false;
      if (field.values.empty() && !field.flags) {
        const char* const end = column.value.print(number, data);
        put_right(out, {number, static_cast<std::size_t>(end - number)}, column.width);
      } else {
        const std::int64_t raw = column.value.raw(data);
        std::string text = names_of(field, raw);
        if (text.empty())
          text.assign(number, static_cast<std::size_t>(column.value.print(number, data) - number));
        named = std::any_of(field.values.begin(), field.values.end(),
                            [&](const auto& value) { return has_name(field, value, raw); });
        if (named && topic.is_message()) {  // a file from elsewhere may name several values alike
          const char* const end = column.value.print(number, data);
          text.append(" (").append(number, static_cast<std::size_t>(end - number));
          if (!column.unit_of_all) text += column.unit;
          text += ')';
        }
        put_right(out, text, column.width);
      }
      if (column.unit_of_all || !named) out.append(column.unit);  // a name in place of a number has none
    }
  }

  static void request(Buffer& out, const protocol::Topic& topic, const can::Frame& frame) {
    const auto request = protocol::decode_request(frame);
    if (!request)
      return append_formatted(out, "bad request {}: {}", can::to_text(frame).view(),
                              base::describe(request.error));
    switch (request->mode) {
      case protocol::Mode::stop:
        out.append("stop");
        break;
      case protocol::Mode::once:
        out.append("once");
        break;
      case protocol::Mode::publish:
        out.append("publish every ");
        out.append(words::to_text(frame.dlc == 1 ? topic.period : request->period));
        break;
    }
  }

  bool colour_;
  bool everything_;
  Columns terminal_columns_;
  std::size_t width_ = SIZE_MAX;     ///< of the terminal, now
  std::size_t name_width_ = 0;       ///< of the longest name of a topic
  std::vector<std::size_t> breaks_;  ///< of the line that is written: where it may go on in another
  bool started_ = false;
  base::Time begin_{};
  std::array<std::string, protocol::priority_levels> priorities_;
  std::unordered_map<const protocol::Topic*, TopicText> topics_;
};

}  // namespace

std::unique_ptr<Output> make_pretty(const protocol::Catalogue& catalogue, const Selection& selection,
                                    bool colour, Columns columns) {
  return std::make_unique<Pretty>(catalogue, selection, colour, columns);
}

}  // namespace ocm::cli
