// The rows of the picture and their fields: which columns there is room for, and what is in each.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "ocm/client/counted.hpp"

#include "cli/output/field_text.hpp"
#include "cli/output/named_value.hpp"
#include "cli/top/short_number.hpp"
#include "cli/top/view.hpp"

namespace ocm::cli::top {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t room_for_both = 36;  ///< "due every 100ms " and a value

/// A field's value for a person: names where it has some, else the number.
std::string value_of(const protocol::Field& field, std::span<const std::uint8_t> data) {
  if (std::string names = names_of(field, field.raw(data)); !names.empty()) return names;
  char text[FieldText::room];
  const FieldText number{field};
  return {text, static_cast<std::size_t>(number.print(text, data.data()) - text)};
}

std::string label_of(const protocol::Topic& topic, std::size_t frame, const protocol::Field& field) {
  const protocol::FrameLayout& layout = topic.frames[frame];
  if (topic.frames.size() == 1 || layout.name.empty()) return std::string{field.name};
  if (layout.values().size() == 1) return std::string{layout.name};
  return fmt::format("{}.{}", layout.name, field.name);
}

/// Of a topic without a whole sample.
std::string what_came(const Row& row) {
  if (row.frames == 0) return "nothing came";
  if (row.frames == row.wrong_length)
    return fmt::format("no sample, {} of a wrong length", client::counted(row.frames, "frame"));
  if (row.incomplete == 0) return "no whole sample yet";
  return fmt::format("no whole sample, {} incomplete", row.incomplete);
}

Style style_of(const Row& row) {
  switch (row.health) {
    case Health::fine:
      break;
    case Health::late:
      return Style::warning;
    case Health::missing:
      return Style::bad;
  }
  return Style::plain;
}

}  // namespace

View::Columns::Columns(std::size_t width, std::size_t longest_name) {
  name = std::clamp<std::size_t>(longest_name, 8, std::max<std::size_t>(width / 4, 12));
  if (width >= 56) age = 6;
  if (width >= 70) jitter = 6;
  if (width >= 78) share = 6;
  if (width >= 96) changed = 7;
  if (width >= 110) faults = 6;
  if (width >= 120) count = 9;
}

Line View::heading(const Columns& columns, std::size_t width) const {
  LineWriter line{width};
  const auto head = [&](std::string_view text, std::size_t size, Sort sort, bool to_right = true) {
    if (size == 0) return;
    const Style style = sort == sort_ && sort != Sort::spec ? Style::sorted : Style::heading;
    line.put((to_right ? right(text, size) : left(text, size)), style);
    line.put(" ", Style::heading);
  };
  head("NAME", columns.name, Sort::name, false);
  head("HZ", columns.rate, Sort::rate);
  head("JITTER", columns.jitter, Sort::jitter);
  head("AGE", columns.age, Sort::age);
  head("BUS", columns.share, Sort::share);
  head("CHANGED", columns.changed, Sort::changed);
  head("FAULTS", columns.faults, Sort::spec);
  head("COUNT", columns.count, Sort::count);
  line.put("VALUES", Style::heading);
  line.fill(width, Style::heading);
  return line.take();
}

Line View::row_line(const Columns& columns, const Scene& scene, const Item& item, std::size_t width) {
  const Row& row = *item.row;
  const bool selected = cursor_ && item.key == *cursor_;
  const Style style = selected ? Style::selected : style_of(row);
  const Style faint = selected ? Style::selected : style == Style::plain ? Style::dim : style;
  LineWriter line{width};
  std::string name =
      scene.buses.size() > 1 ? fmt::format("{}:{}", scene.buses[item.key.bus].name, row.name) : row.name;
  line.put(left(name, columns.name) + ' ', selected ? style : style == Style::plain ? Style::bold : style);
  const auto cell = [&](std::size_t size, std::string_view text, Style how) {
    if (size > 0) line.put(right(text, size) + ' ', how);
  };
  const bool any = row.recent.distances > 0;
  cell(columns.rate, any ? short_number(row.recent.rate_hz) : "-", style);
  cell(columns.jitter, any ? short_time(base::Duration{std::llround(row.recent.jitter_ns)}) : "-", faint);
  cell(columns.age, row.age ? short_time(*row.age) : "-", style);
  cell(columns.share, row.frames > 0 && row.share ? percent(*row.share) : "-", faint);
  cell(columns.changed, row.unchanged ? short_time(*row.unchanged) : "-", faint);
  const Style wrong = selected ? Style::selected : row.faults > 0 ? Style::warning : Style::dim;
  cell(columns.faults, fmt::format("{}", row.faults), wrong);
  cell(columns.count, fmt::format("{}", row.count), faint);
  const auto finished = [&] {
    if (selected) line.fill(width, Style::selected);
    return line.take();
  };
  // Of a topic with values only where there is room for one beside it; the colour says it, too.
  if (row.health != Health::fine && row.period && (!row.has_bytes() || line.room() >= room_for_both))
    line.put_whole(fmt::format("due every {} ", short_time(*row.period)), style);
  if (row.topic == nullptr) {
    const auto& bytes = row.newest.bytes;
    for (std::size_t i = 0; i < bytes.size(); ++i)
      if (!line.put_whole(fmt::format("{}{:02X}", i == 0 ? "" : " ", bytes[i]), style)) break;
    return finished();
  }
  if (row.count == 0) {
    line.put_whole(what_came(row), row.frames > 0 && !selected ? Style::warning : faint);
    return finished();
  }
  bool first = true;
  for (std::size_t frame = 0; frame < row.topic->frames.size(); ++frame) {
    const auto& layout = row.topic->frames[frame];
    const auto data = row.newest.data(frame);
    for (std::size_t i = 0; i < layout.values().size(); ++i) {
      const protocol::Field& field = layout.values()[i];
      if (!layout.has(field, data)) continue;
      const std::string value = value_of(field, data);
      ItemKey key = item.key;
      key.frame = static_cast<int>(frame);
      key.field = static_cast<int>(i);
      std::size_t& widest = widths_[key];
      widest = std::max(widest, base::columns(value));
      const std::string label = (first ? "" : "  ") + label_of(*row.topic, frame, field) + ' ';
      const std::string unit = field.unit.empty() ? std::string{} : ' ' + std::string{field.unit};
      // A number is shown whole or not at all; the first one rather without its name than not.
      if (base::columns(label) + widest + base::columns(unit) > line.room()) {
        if (first)
          (void)(line.put_whole(label + value + unit, style) || line.put_whole(value + unit, style) ||
                 line.put_whole(value, style));
        line.put(unicode_ ? " …" : " >", faint);
        return finished();
      }
      line.put(label, faint);
      line.put(right(value, widest), style);
      line.put(unit, faint);
      first = false;
    }
  }
  return finished();
}

Line View::field_line(const Columns& columns, const Scene& scene, const Item& item, std::size_t width) {
  const Row& row = *item.row;
  const auto frame = static_cast<std::size_t>(item.key.frame);
  const auto& layout = row.topic->frames[frame];
  const protocol::Field& field = layout.values()[static_cast<std::size_t>(item.key.field)];
  const auto data = row.newest.data(frame);
  const bool present = layout.has(field, data);
  const bool selected = cursor_ && item.key == *cursor_;

  Seen& seen = seen_[item.key];
  if (present) {
    const std::int64_t raw = field.raw(data);
    if (seen.changed == base::Time{} || raw != seen.raw) seen = {raw, {}, scene.now};
    seen.text = value_of(field, data);
  }
  const bool fresh = scene.now - seen.changed < 1s;
  const Style faint = selected ? Style::selected : Style::dim;
  const Style value_style = selected ? Style::selected : fresh ? Style::bold : Style::plain;

  LineWriter line{width};
  std::size_t longest = 0;
  for (std::size_t i = 0; i < row.topic->frames.size(); ++i)
    for (const auto& each : row.topic->frames[i].values())
      longest = std::max(longest, base::columns(label_of(*row.topic, i, each)));
  const std::size_t label =
      std::clamp<std::size_t>(longest + 2, columns.name, std::max(columns.name, width * 2 / 5));
  line.put(left("  " + label_of(*row.topic, frame, field), label) + ' ',
           selected ? Style::selected : Style::plain);
  const std::string value = seen.text.empty() ? "-" : seen.text;
  const std::string unit = field.unit.empty() ? std::string{} : ' ' + std::string{field.unit};
  line.put_whole(right(value, std::min<std::size_t>(12, line.room())) +
                     left(unit, std::max<std::size_t>(base::columns(unit), 6)),
                 value_style);
  if (graphs_.contains(item.key)) {
    const FieldKey key{item.key.row, static_cast<std::uint8_t>(item.key.frame),
                       static_cast<std::uint16_t>(item.key.field)};
    const auto values = scene.buses[item.key.bus].model->history(key);
    double low = 0, high = 0;
    bool any = false;
    for (const double number : values) {
      if (!std::isfinite(number)) continue;
      low = any ? std::min(low, number) : number;
      high = any ? std::max(high, number) : number;
      any = true;
    }
    const std::string range = any ? fmt::format(" {:.4g}..{:.4g}", low, high) : "";
    if (line.room() > range.size() + 4) {
      line.put(" ");
      line.put(graph(values, std::min(line.room() - range.size(), Model::history_size)),
               selected ? Style::selected : Style::good);
      line.put(range, faint);
    }
  } else if (!fresh && !seen.text.empty()) {
    line.put_whole(fmt::format("  unchanged {}", short_time(scene.now - seen.changed)), faint);
  }
  if (selected) line.fill(width, Style::selected);
  return line.take();
}

/// The newest values, the last one at the right end.
std::string View::graph(const std::vector<double>& values, std::size_t width) const {
  static constexpr std::array<std::string_view, 8> blocks{"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  static constexpr std::array<std::string_view, 8> letters{"_", ".", "-", ":", "=", "+", "*", "#"};
  const std::size_t count = std::min(width, values.size());
  const auto begin = values.end() - static_cast<std::ptrdiff_t>(count);
  double low = 0, high = 0;
  bool any = false;
  for (auto at = begin; at != values.end(); ++at) {
    if (!std::isfinite(*at)) continue;
    low = any ? std::min(low, *at) : *at;
    high = any ? std::max(high, *at) : *at;
    any = true;
  }
  std::string text;
  for (auto at = begin; at != values.end(); ++at) {
    if (!std::isfinite(*at)) {
      text += ' ';
      continue;
    }
    const double height = high > low ? (*at - low) / (high - low) : 0;
    const auto level = static_cast<std::size_t>(std::clamp(height * 8, 0.0, 7.0));
    text += unicode_ ? blocks[level] : letters[level];
  }
  return text;
}

}  // namespace ocm::cli::top
