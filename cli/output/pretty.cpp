/// A person's view: one line a sample, with time since the first frame, priority, topic, and the values with
/// their units in columns. Samples of several frames appear when they are complete.
#include <algorithm>
#include <array>
#include <string>
#include <unordered_map>
#include <vector>

#include "ocm/can/error_frame.hpp"
#include "ocm/can/text.hpp"
#include "ocm/protocol/request.hpp"
#include "ocm/reflective/quantity.hpp"

#include "cli/output/output.hpp"

namespace ocm::cli {
namespace {

/// What one value is called and how wide it may become.
struct Column {
  std::string label;
  std::size_t frame = 0;
  const protocol::Field* field = nullptr;
  std::size_t width = 0;
};

class Pretty final : public Output {
 public:
  Pretty(const protocol::Catalogue& catalogue, bool colour) : colour_(colour) {
    for (const auto& topic : catalogue.topics) {
      name_width_ = std::max(name_width_, topic.name.size());
      columns_.emplace(&topic, columns_of(topic));
    }
  }

  void write(Buffer& out, const Event& event) override {
    using reflective::Meaning;
    const auto& frame = event.received.frame;
    switch (event.reception.meaning) {
      case Meaning::part:
        return;
      case Meaning::sample:
        head(out, event, "");
        values(out, *event.reception.topic, event.reception.sample.payloads);
        break;
      case Meaning::set_point:
        head(out, event, "<- ");
        values(out, *event.reception.topic, std::span{&frame.data, 1});
        break;
      case Meaning::request:
        head(out, event, "<- ");
        request(out, *event.reception.topic, frame);
        break;
      case Meaning::wrong_dlc:
        head(out, event, "");
        paint(out, red);
        fmt::format_to(std::back_inserter(out), "DLC {} instead of {}: {}", frame.dlc,
                       event.reception.frame.layout().dlc, can::to_text(frame).view());
        paint(out, plain);
        break;
      case Meaning::unknown:
        time(out, event);
        fmt::format_to(std::back_inserter(out), "{:<7} unknown: {}", "-", can::to_text(frame).view());
        break;
      case Meaning::error:
        time(out, event);
        paint(out, red);
        fmt::format_to(std::back_inserter(out), "{:<7} error frame: {}", "-", can::describe(frame).view());
        paint(out, plain);
        break;
    }
    out.push_back('\n');
  }

 private:
  static constexpr std::string_view plain = "\033[0m";
  static constexpr std::string_view dim = "\033[2m";
  static constexpr std::string_view bold = "\033[1m";
  static constexpr std::string_view red = "\033[31m";

  void paint(Buffer& out, std::string_view code) const {
    if (colour_) append(out, code);
  }

  void time(Buffer& out, const Event& event) {
    if (!started_) begin_ = event.received.time;
    started_ = true;
    const std::int64_t us = (event.received.time - begin_).count() / 1000;
    paint(out, dim);
    fmt::format_to(std::back_inserter(out), "{}{:>5}.{:06}  ", us < 0 ? "-" : "", std::abs(us) / 1'000'000,
                   std::abs(us) % 1'000'000);
    paint(out, plain);
  }

  void head(Buffer& out, const Event& event, std::string_view arrow) {
    constexpr std::array<std::string_view, 4> codes{"\033[31m", "\033[33m", "\033[32m", "\033[36m"};
    time(out, event);
    const auto priority = protocol::Identifier::decode(event.received.frame.id).priority;
    paint(out, codes[static_cast<std::size_t>(priority)]);
    fmt::format_to(std::back_inserter(out), "{:<7} ", name(priority));
    paint(out, plain);
    paint(out, bold);
    fmt::format_to(std::back_inserter(out), "{:<{}}  ", event.reception.topic->name, name_width_);
    paint(out, plain);
    append(out, arrow);
  }

  static std::vector<Column> columns_of(const protocol::Topic& topic) {
    std::vector<Column> columns;
    for (std::size_t i = 0; i < topic.frames.size(); ++i) {
      const auto& layout = topic.frames[i];
      for (const auto& field : layout.fields) {
        Column column{std::string{field.name}, i, &field, 1};
        if (topic.frames.size() > 1) {
          column.label = layout.name;
          if (layout.fields.size() > 1) column.label.append(".").append(field.name);
        }
        for (const std::int64_t raw : {field.raw_min, field.raw_max})
          if (const auto bound = field.physical(raw))
            column.width = std::max(column.width, base::to_text(*bound).view().size());
        // A whole bound says nothing of the digits behind the point.
        if (field.scale.exponent < 0)
          column.width = std::max(column.width, static_cast<std::size_t>(2 - field.scale.exponent));
        column.width = std::min<std::size_t>(column.width, 11);
        columns.push_back(std::move(column));
      }
    }
    return columns;
  }

  static std::string value_text(const protocol::Field& field, const can::Payload& data) {
    const std::int64_t raw = field.raw(data);
    std::string text;
    for (const auto& value : field.values) {
      const bool applies = field.flags ? (raw >> value.raw & 1) != 0 : raw == value.raw;
      if (!applies) continue;
      if (!text.empty()) text += '|';
      text += value.name;
    }
    if (!text.empty()) return text;
    if (field.flags) return raw == 0 ? "-" : fmt::format("0x{:X}", raw);
    return std::string{base::to_text(physical(field, data)).view()};
  }

  void values(Buffer& out, const protocol::Topic& topic, std::span<const can::Payload> payloads) const {
    const auto& columns = columns_.at(&topic);
    const bool one_unit = std::all_of(columns.begin(), columns.end(), [&](const Column& column) {
      return column.field->unit == columns[0].field->unit;
    });
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const Column& column = columns[i];
      const auto& field = *column.field;
      if (i != 0) append(out, "  ");
      paint(out, dim);
      append(out, column.label);
      paint(out, plain);
      fmt::format_to(std::back_inserter(out), " {:>{}}", value_text(field, payloads[column.frame]),
                     column.width);
      // One unit for all stands at the end; a name in place of a number has none.
      const std::int64_t raw = field.raw(payloads[column.frame]);
      const bool named = std::any_of(field.values.begin(), field.values.end(),
                                     [raw](const auto& value) { return value.raw == raw; });
      if (!field.unit.empty() && (one_unit ? i + 1 == columns.size() : !named))
        fmt::format_to(std::back_inserter(out), " {}", field.unit);
    }
  }

  static void request(Buffer& out, const protocol::Topic& topic, const can::Frame& frame) {
    const auto request = protocol::decode_request(frame);
    if (!request) {
      fmt::format_to(std::back_inserter(out), "bad request {}: {}", can::to_text(frame).view(),
                     base::describe(request.error));
      return;
    }
    switch (request->mode) {
      case protocol::Mode::stop:
        append(out, "stop");
        break;
      case protocol::Mode::once:
        append(out, "once");
        break;
      case protocol::Mode::publish:
        append(out, "publish every ");
        append(out, reflective::to_text(frame.dlc == 1 ? topic.period : request->period));
        break;
    }
  }

  bool colour_;
  bool started_ = false;
  base::Time begin_{};
  std::size_t name_width_ = 0;
  std::unordered_map<const protocol::Topic*, std::vector<Column>> columns_;
};

}  // namespace

std::unique_ptr<Output> make_pretty(const protocol::Catalogue& catalogue, bool colour) {
  return std::make_unique<Pretty>(catalogue, colour);
}

}  // namespace ocm::cli
