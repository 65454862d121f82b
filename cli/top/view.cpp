#include "cli/top/view.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "ocm/base/utf8.hpp"

#include "cli/output/field_text.hpp"
#include "cli/output/named_value.hpp"
#include "cli/shared/folding.hpp"

namespace ocm::cli::top {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t room_for_both = 36;  ///< "due every 100ms " and a value

/// Puts pieces behind each other, as far as there is room.
class Writer {
 public:
  explicit Writer(std::size_t width) : width_(width) {}

  [[nodiscard]] std::size_t room() const noexcept { return width_ - used_; }
  [[nodiscard]] std::size_t used() const noexcept { return used_; }

  /// Cut at the end of the line.
  void put(std::string_view text, Style style = Style::plain) {
    std::size_t bytes = 0, columns = 0;
    while (bytes < text.size() && columns < room()) {
      bytes += std::max<std::size_t>(base::utf8_length(text.substr(bytes)), 1);
      ++columns;
    }
    used_ += columns;
    if (!line_.empty() && line_.back().style == style)
      line_.back().text += text.substr(0, bytes);
    else if (bytes > 0)
      line_.push_back({std::string{text.substr(0, bytes)}, style});
  }
  /// All of it or nothing; whether it had room.
  bool put_whole(std::string_view text, Style style = Style::plain) {
    if (base::columns(text) > room()) return false;
    put(text, style);
    return true;
  }
  void fill(std::size_t until, Style style = Style::plain) {
    if (until > used_) put(std::string(std::min(until, width_) - used_, ' '), style);
  }
  [[nodiscard]] Line take() { return std::move(line_); }

 private:
  std::size_t width_;
  std::size_t used_ = 0;
  Line line_;
};

/// A text in so many columns.
std::string left(std::string_view text, std::size_t width) {
  std::size_t bytes = 0, columns = 0;
  while (bytes < text.size() && columns < width) {
    bytes += std::max<std::size_t>(base::utf8_length(text.substr(bytes)), 1);
    ++columns;
  }
  return std::string{text.substr(0, bytes)} + std::string(width - columns, ' ');
}
std::string right(std::string_view text, std::size_t width) {
  const std::size_t columns = base::columns(text);
  return columns < width ? std::string(width - columns, ' ') + std::string{text} : std::string{text};
}

std::string percent(double share) {
  return share > 0 && share < 0.0005 ? "<0.1%" : fmt::format("{:.1f}%", 100 * share);
}

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

bool has_bytes(const Row& row) {
  return row.count > 0 && row.newest.topic != nullptr;
}

bool contains(std::string_view text, std::string_view part) {
  const auto same = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
  };
  return std::search(text.begin(), text.end(), part.begin(), part.end(), same) != text.end();
}

constexpr std::array<std::pair<Sort, std::string_view>, 8> sorts{{{Sort::spec, "the spec"},
                                                                  {Sort::name, "name"},
                                                                  {Sort::rate, "rate"},
                                                                  {Sort::jitter, "jitter"},
                                                                  {Sort::age, "age"},
                                                                  {Sort::share, "share of the bus"},
                                                                  {Sort::changed, "last change"},
                                                                  {Sort::count, "count"}}};

/// `right` columns beside it are for what follows.
void load_bar(Writer& line, double load, std::size_t right) {
  const std::string words = fmt::format(" {:>6} ", percent(load));
  const std::size_t beside = words.size() + 2 + std::max(line.room() / 3, right);
  const std::size_t bar = std::min<std::size_t>(40, line.room() - std::min(line.room(), beside));
  const auto filled =
      static_cast<std::size_t>(std::lround(std::clamp(load, 0.0, 1.0) * static_cast<double>(bar)));
  line.put("[", Style::dim);
  line.put(std::string(filled, '|'), load > 0.8 ? Style::bad : load > 0.5 ? Style::warning : Style::good);
  line.put(std::string(bar - filled, ' '));
  line.put("]", Style::dim);
  line.put(words, Style::bold);
}

/// What is greatest comes first, but for the names and the spec's order.
bool is_before(Sort sort, const Row& a, const Row& b) {
  constexpr base::Duration never = base::Duration::max();
  switch (sort) {
    case Sort::spec:
      break;
    case Sort::name:
      return a.name < b.name;
    case Sort::rate:
      return a.recent.rate_hz > b.recent.rate_hz;
    case Sort::jitter:
      return a.recent.jitter_ns > b.recent.jitter_ns;
    case Sort::age:
      return a.age.value_or(never) > b.age.value_or(never);
    case Sort::share:
      return a.share.value_or(0) > b.share.value_or(0);
    case Sort::changed:
      return a.unchanged.value_or(never) < b.unchanged.value_or(never);
    case Sort::count:
      return a.count > b.count;
  }
  return false;
}

Style style_of(can::ControllerState state) {
  switch (state) {
    case can::ControllerState::active:
      return Style::dim;
    case can::ControllerState::warning:
      return Style::warning;
    case can::ControllerState::passive:
    case can::ControllerState::bus_off:
      break;
  }
  return Style::bad;
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

std::string short_time(base::Duration duration) {
  const double ns = std::abs(static_cast<double>(duration.count()));
  const std::string_view sign = duration.count() < 0 ? "-" : "";
  const auto text = [&](double number, std::string_view unit) {
    return fmt::format("{}{:.{}f}{}", sign, number, number < 9.95 ? 1 : 0, unit);
  };
  if (ns < 999.5e3) return fmt::format("{}{:.0f}us", sign, ns / 1e3);
  if (ns < 999.5e6) return text(ns / 1e6, "ms");
  if (ns < 99.5e9) return fmt::format("{}{:.1f}s", sign, ns / 1e9);
  if (ns < 99.5 * 60e9) return fmt::format("{}{:.0f}m", sign, ns / 60e9);
  if (ns < 99.5 * 3600e9) return fmt::format("{}{:.0f}h", sign, ns / 3600e9);
  return fmt::format("{}{:.0f}d", sign, ns / 86400e9);
}

std::string short_number(double number) {
  if (number < 9.995) return fmt::format("{:.2f}", number);
  if (number < 999.95) return fmt::format("{:.1f}", number);
  return number < 999'999.5 ? fmt::format("{:.0f}", number) : fmt::format("{:.0f}k", number / 1000);
}

/// Which columns a width has room for; 0: none of that.
struct View::Columns {
  std::size_t name = 12;
  std::size_t rate = 6, age = 0, jitter = 0, share = 0, changed = 0, faults = 0, count = 0;

  explicit Columns(std::size_t width, std::size_t longest_name) {
    name = std::clamp<std::size_t>(longest_name, 8, std::max<std::size_t>(width / 4, 12));
    if (width >= 56) age = 6;
    if (width >= 70) jitter = 6;
    if (width >= 78) share = 6;
    if (width >= 96) changed = 7;
    if (width >= 110) faults = 6;
    if (width >= 120) count = 9;
  }
};

View::Rows View::chosen_rows(const Scene& scene) const {
  Rows rows;
  for (std::size_t bus = 0; bus < scene.buses.size(); ++bus)
    for (Row& row : scene.buses[bus].model->rows(scene.now, all_ || !only_.empty()))
      if (matches(scene.buses[bus].name, row)) rows.emplace_back(bus, std::move(row));
  std::stable_sort(rows.begin(), rows.end(), [this](const auto& a, const auto& b) {
    return reversed_ ? is_before(sort_, b.second, a.second) : is_before(sort_, a.second, b.second);
  });
  if (sort_ == Sort::spec && reversed_) std::reverse(rows.begin(), rows.end());
  // What does not come comes first.
  std::stable_sort(rows.begin(), rows.end(),
                   [](const auto& a, const auto& b) { return a.second.health > b.second.health; });
  return rows;
}

/// A name, a field's name, or a bus that has the letters in it.
bool View::matches(std::string_view bus, const Row& row) const {
  if (!only_.empty() && !only_.contains(row.topic)) return false;
  if (filter_.empty() || contains(row.name, filter_) || contains(bus, filter_)) return true;
  if (row.topic == nullptr) return false;
  for (const auto& layout : row.topic->frames)
    for (const auto& field : layout.values())
      if (contains(field.name, filter_)) return true;
  return false;
}

std::vector<View::Item> View::items(const Rows& rows) const {
  std::vector<Item> items;
  for (const auto& [bus, row] : rows) {
    const ItemKey key{bus, row.number};
    items.push_back({key, &row});
    if (!has_bytes(row)) continue;
    const bool open = open_.contains({bus, row.number});
    for (std::size_t frame = 0; frame < row.topic->frames.size(); ++frame) {
      const auto& layout = row.topic->frames[frame];
      const auto data = row.newest.data(frame);
      for (std::size_t field = 0; field < layout.values().size(); ++field) {
        ItemKey of_field = key;
        of_field.frame = static_cast<int>(frame);
        of_field.field = static_cast<int>(field);
        if ((open && layout.has(layout.values()[field], data)) || graphs_.contains(of_field))
          items.push_back({of_field, &row});
      }
    }
  }
  return items;
}

std::size_t View::cursor_index() const {
  if (!cursor_) return 0;
  const auto at = std::find_if(order_.begin(), order_.end(),
                               [this](const Place& place) { return place.key == *cursor_; });
  if (at != order_.end()) return static_cast<std::size_t>(at - order_.begin());
  // A field that is folded away: its row.
  const auto row = std::find_if(order_.begin(), order_.end(), [this](const Place& place) {
    return place.key.is_row() && place.key.bus == cursor_->bus && place.key.row == cursor_->row;
  });
  return row == order_.end() ? 0 : static_cast<std::size_t>(row - order_.begin());
}

void View::keep_cursor_in_sight(std::size_t lines) {
  if (order_.empty()) {
    first_ = 0;
    return;
  }
  // Until the user moves, the beginning is shown, whatever comes there.
  const std::size_t at = cursor_ ? cursor_index() : 0;
  if (cursor_) cursor_ = order_[at].key;
  if (at < first_) first_ = at;
  if (at >= first_ + lines) first_ = at - lines + 1;
  first_ = std::min(first_, order_.size() - std::min(order_.size(), lines));
}

void View::heads(Picture& picture, const Scene& scene, const Rows& rows, std::size_t width) const {
  Writer title{width};
  title.put(scene.source, Style::bold);
  if (!scene.robot.empty()) title.put(fmt::format(" {}", scene.robot), Style::dim);
  const auto of = [&rows](Health health) {
    return std::count_if(rows.begin(), rows.end(),
                         [&](const auto& row) { return row.second.health == health; });
  };
  if (scene.waiting) title.put("  BUS DOWN", Style::bad);
  if (scene.paused) title.put("  PAUSED", Style::warning);
  if (const auto missing = of(Health::missing); missing > 0)
    title.put(fmt::format("  {} missing", missing), Style::bad);
  if (const auto late = of(Health::late); late > 0) title.put(fmt::format("  {} late", late), Style::warning);
  if (!filter_.empty() && !typing_) title.put(fmt::format("  /{}", filter_), Style::good);
  if (sort_ != Sort::spec || reversed_)
    for (const auto& [sort, name] : sorts)
      if (sort == sort_) title.put(fmt::format("  by {}{}", name, reversed_ ? ", reversed" : ""), Style::dim);
  picture.push_back(title.take());

  std::size_t name = 0;
  for (const Bus& bus : scene.buses) name = std::max(name, base::columns(bus.name));
  for (const Bus& bus : scene.buses) {
    const Summary sum = bus.model->summary(scene.now);
    Writer line{width};
    if (scene.buses.size() > 1) line.put(left(bus.name, name) + ' ', Style::bold);
    const std::string rate = fmt::format("{} frames/s", short_number(sum.rate_hz));
    if (sum.load_known) load_bar(line, sum.load, rate.size());
    if (!line.put_whole(rate)) line.put(std::string(line.room(), ' '));  // what follows is worth less
    if (sum.load_known)
      line.put_whole(fmt::format("  worst {}", percent(sum.worst_load)), Style::dim);
    else
      line.put_whole("  its load: --bitrate 500k", Style::dim);
    picture.push_back(line.take());

    Writer counters{width};
    if (sum.controller)
      counters.put_whole(fmt::format("{}  ", can::name(*sum.controller)), style_of(*sum.controller));
    if (sum.error_counters)
      counters.put_whole(
          fmt::format("TEC {} REC {}  ", sum.error_counters->transmit, sum.error_counters->receive),
          sum.controller ? style_of(*sum.controller) : Style::dim);
    counters.put_whole(fmt::format("{} frame{}", sum.frames, sum.frames == 1 ? "" : "s"), Style::dim);
    const auto count = [&](std::uint64_t number, std::string_view what, Style bad) {
      if (number > 0) counters.put_whole(fmt::format("  {} {}", number, what), bad);
    };
    count(sum.errors, sum.errors == 1 ? "error frame" : "error frames", Style::bad);
    count(sum.overflows, sum.overflows == 1 ? "overflow" : "overflows", Style::bad);
    count(sum.lost, "lost", Style::bad);
    count(sum.incomplete, "incomplete", Style::warning);
    count(sum.wrong_length, "of a wrong length", Style::warning);
    count(sum.unknown, "unknown", Style::dim);
    count(sum.not_shown, "of more identifiers than are shown", Style::warning);
    count(sum.not_in_load, "CAN FD, not in the load", Style::dim);
    picture.push_back(counters.take());
  }
}

Line View::heading(const Columns& columns, std::size_t width) const {
  Writer line{width};
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
  Writer line{width};
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
  cell(columns.share, row.count > 0 && row.share ? percent(*row.share) : "-", faint);
  cell(columns.changed, row.unchanged ? short_time(*row.unchanged) : "-", faint);
  const Style wrong = selected ? Style::selected : row.faults > 0 ? Style::warning : Style::dim;
  cell(columns.faults, fmt::format("{}", row.faults), wrong);
  cell(columns.count, fmt::format("{}", row.count), faint);
  const auto finished = [&] {
    if (selected) line.fill(width, Style::selected);
    return line.take();
  };
  // Of a topic with values only where there is room for one beside it; the colour says it, too.
  if (row.health != Health::fine && row.period && (!has_bytes(row) || line.room() >= room_for_both))
    line.put_whole(fmt::format("due every {} ", short_time(*row.period)), style);
  if (row.topic == nullptr) {
    const auto& bytes = row.newest.bytes;
    for (std::size_t i = 0; i < bytes.size(); ++i)
      if (!line.put_whole(fmt::format("{}{:02X}", i == 0 ? "" : " ", bytes[i]), style)) break;
    return finished();
  }
  if (row.count == 0) {
    line.put_whole("nothing came", faint);
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
  if (const std::int64_t raw = present ? field.raw(data) : 0; seen.changed == base::Time{} || raw != seen.raw)
    seen = {raw, scene.now};
  const bool fresh = scene.now - seen.changed < 1s;
  const Style faint = selected ? Style::selected : Style::dim;
  const Style value_style = selected ? Style::selected : fresh ? Style::bold : Style::plain;

  Writer line{width};
  std::size_t longest = 0;
  for (std::size_t i = 0; i < row.topic->frames.size(); ++i)
    for (const auto& each : row.topic->frames[i].values())
      longest = std::max(longest, base::columns(label_of(*row.topic, i, each)));
  const std::size_t label =
      std::clamp<std::size_t>(longest + 2, columns.name, std::max(columns.name, width * 2 / 5));
  line.put(left("  " + label_of(*row.topic, frame, field), label) + ' ',
           selected ? Style::selected : Style::plain);
  const std::string value = present ? value_of(field, data) : "-";
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
  } else if (!fresh) {
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

Line View::foot(const Scene& scene, std::size_t width) const {
  Writer line{width};
  if (typing_) {
    line.put("/" + filter_, Style::bold);
    line.put("_", Style::dim);
    line.put_whole("   Enter keeps it, Esc drops it", Style::dim);
    return line.take();
  }
  if (!scene.message.empty()) {
    line.put(scene.message, Style::warning);
    return line.take();
  }
  for (const std::string_view words : {"? help", "  q quit", "  / filter", "  Enter open", "  Space graph",
                                       "  < > sort", "  p pause", "  a all"})
    if (!line.put_whole(words, Style::dim)) break;
  return line.take();
}

Line View::time_bar(const Playing& playing, bool paused, std::size_t width) const {
  Writer line{width};
  const auto seconds = [](base::Duration time) {
    return fmt::format("{:.1f}", static_cast<double>(time.count()) / 1e9);
  };
  const std::string length = seconds(playing.length);
  line.put(fmt::format("{} of {} s ", right(seconds(playing.at), length.size()), length));
  const std::string how =
      playing.ended ? " end" : fmt::format(" x{:g}{}", playing.speed, paused ? " paused" : "");
  const std::size_t bar = line.room() - std::min(line.room(), how.size() + 2);
  const double share = playing.length.count() > 0 ? static_cast<double>(playing.at.count()) /
                                                        static_cast<double>(playing.length.count())
                                                  : 1;
  const auto filled =
      static_cast<std::size_t>(std::lround(std::clamp(share, 0.0, 1.0) * static_cast<double>(bar)));
  if (bar > 4) {
    line.put("[", Style::dim);
    line.put(std::string(filled, '='), Style::good);
    line.put(std::string(bar - filled, ' '));
    line.put("]", Style::dim);
  }
  line.put(how, Style::bold);
  return line.take();
}

/// Keys and what they do; a text without keys. Lines that a screen is too narrow for are broken between
/// words; those that it is too low for are not there.
Picture View::help(TerminalSize size) const {
  static constexpr std::string_view lines[] = {
      "Up Down PgUp PgDn Home End   move; also j k g G",
      "Enter + -                    open or close a row: a line a field",
      "*                            open all, or close all",
      "Space                        draw a graph of the field (of a row: of all its fields)",
      "/                            show only names with these letters; Esc: all again",
      "< >                          sort by another column; I turns the order round",
      "a                            also what the spec has and nothing came of",
      "p                            pause; p again goes on",
      "Left Right , .               in a log: 10 s and 1 s back or on; 0: to its beginning",
      "[ ]                          in a log: half or twice the speed",
      "q                            quit",
      "",
      "Late (1.5 periods) and missing (3 periods) rows come first, whatever the order.",
      "HZ and JITTER are of the last two seconds, BUS of the last second.",
      "",
      "Any key leaves this page.",
  };
  Picture picture;
  // On a narrow terminal keys and words are closer together.
  const std::size_t key_columns = size.columns < 80 ? 0 : 29;
  for (const std::string_view text : lines) {
    const std::size_t gap = std::min(text.find("   "), text.size());
    const std::string_view words = text.substr(std::min(text.find_first_not_of(' ', gap), text.size()));
    std::string keys{text.substr(0, words.empty() ? 0 : gap)};
    if (!keys.empty()) keys = left(keys, std::max(key_columns, base::columns(keys) + 2));
    const std::string folded = cli::folded(keys + std::string{words.empty() ? text : words}, size.columns,
                                           keys.empty()       ? 0
                                           : key_columns == 0 ? 2
                                                              : key_columns);
    for (std::size_t begin = 0; begin <= folded.size() && picture.size() < size.rows;) {
      const std::size_t end = std::min(folded.find('\n', begin), folded.size());
      Writer line{size.columns};
      if (begin == 0) line.put(std::string_view{folded}.substr(0, std::min(keys.size(), end)), Style::bold);
      const std::size_t rest = begin == 0 ? std::min(keys.size(), end) : begin;
      line.put(std::string_view{folded}.substr(rest, end - rest));
      picture.push_back(line.take());
      begin = end + 1;
    }
  }
  picture.resize(size.rows);
  return picture;
}

Picture View::draw(const Scene& scene, TerminalSize size) {
  if (help_) return help(size);
  const Rows rows = chosen_rows(scene);
  const std::vector<Item> all = items(rows);
  order_.clear();
  for (const Item& item : all) order_.push_back({item.key, item.row->topic});

  Picture picture;
  heads(picture, scene, rows, size.columns);
  std::size_t longest = 0;
  for (const auto& [bus, row] : rows)
    longest = std::max(longest, base::columns(row.name) +
                                    (scene.buses.size() > 1 ? base::columns(scene.buses[bus].name) + 1 : 0));
  const Columns columns{size.columns, longest};
  picture.push_back(heading(columns, size.columns));
  const std::size_t below = scene.playing ? 2 : 1;
  list_at_ = picture.size();
  list_lines_ = size.rows > list_at_ + below ? size.rows - list_at_ - below : 0;
  keep_cursor_in_sight(list_lines_);
  for (std::size_t i = first_; i < all.size() && i < first_ + list_lines_; ++i)
    picture.push_back(all[i].key.is_row() ? row_line(columns, scene, all[i], size.columns)
                                          : field_line(columns, scene, all[i], size.columns));
  if (all.empty() && list_lines_ > 0) {
    Writer line{size.columns};
    line.put(filter_.empty() ? "nothing came yet" : "no name has these letters", Style::dim);
    picture.push_back(line.take());
  }
  picture.resize(list_at_ + list_lines_);
  if (scene.playing) picture.push_back(time_bar(*scene.playing, scene.paused, size.columns));
  picture.push_back(foot(scene, size.columns));
  picture.resize(size.rows);
  return picture;
}

std::set<FieldKey> View::graphs(std::size_t bus) const {
  std::set<FieldKey> fields;
  for (const ItemKey& key : graphs_)
    if (key.bus == bus)
      fields.insert({key.row, static_cast<std::uint8_t>(key.frame), static_cast<std::uint16_t>(key.field)});
  return fields;
}

void View::move_to(std::size_t item) {
  if (!order_.empty()) cursor_ = order_[std::min(item, order_.size() - 1)].key;
}

void View::move_by(std::ptrdiff_t items) {
  // The first key shows where the cursor is.
  if (!cursor_) return move_to(first_);
  const auto at = static_cast<std::ptrdiff_t>(cursor_index()) + items;
  move_to(static_cast<std::size_t>(std::max<std::ptrdiff_t>(at, 0)));
}

/// A field, or all fields of a row: draws their graphs, or no longer.
void View::pick(const Place& place) {
  if (place.topic == nullptr) return;
  if (!place.key.is_row()) {
    if (graphs_.erase(place.key) == 0) graphs_.insert(place.key);
    return;
  }
  std::vector<ItemKey> fields;
  for (std::size_t frame = 0; frame < place.topic->frames.size(); ++frame)
    for (std::size_t field = 0; field < place.topic->frames[frame].values().size(); ++field)
      fields.push_back({place.key.bus, place.key.row, static_cast<int>(frame), static_cast<int>(field)});
  const bool all =
      std::all_of(fields.begin(), fields.end(), [&](const ItemKey& key) { return graphs_.contains(key); });
  for (const ItemKey& key : fields) {
    if (all)
      graphs_.erase(key);
    else
      graphs_.insert(key);
  }
}

Effect View::type(const Key& key) {
  switch (key.kind) {
    case Key::Kind::character:
      filter_ += key.text;
      break;
    case Key::Kind::backspace:
      while (!filter_.empty() && base::continues_character(filter_.back())) filter_.pop_back();
      if (!filter_.empty()) filter_.pop_back();
      break;
    case Key::Kind::enter:
      typing_ = false;
      break;
    case Key::Kind::escape:
      typing_ = false;
      filter_ = filter_before_;
      break;
    default:
      break;
  }
  return {};
}

Effect View::press(const Key& key) {
  if (help_) {
    help_ = false;
    return {};
  }
  if (typing_) return type(key);
  const auto page = static_cast<std::ptrdiff_t>(std::max<std::size_t>(list_lines_, 2) - 1);
  const auto letter = [&key](std::string_view letters) {
    return key.kind == Key::Kind::character && key.text.size() == 1 &&
           letters.find(key.text) != std::string_view::npos;
  };
  const auto is = [&key](Key::Kind kind, unsigned number = 0) {
    return key.kind == kind && (kind != Key::Kind::function || key.number == number);
  };
  if (letter("q") || is(Key::Kind::function, 10)) return {Effect::Kind::quit, {}};
  if (letter("pZ")) return {Effect::Kind::pause, {}};
  if (letter(",")) return {Effect::Kind::move, -1s};
  if (letter(".")) return {Effect::Kind::move, 1s};
  if (is(Key::Kind::left)) return {Effect::Kind::move, -10s};
  if (is(Key::Kind::right)) return {Effect::Kind::move, 10s};
  if (letter("0")) return {Effect::Kind::rewind, {}};
  if (letter("]")) return {Effect::Kind::faster, {}};
  if (letter("[")) return {Effect::Kind::slower, {}};
  if (letter("h?") || is(Key::Kind::function, 1)) {
    help_ = true;
  } else if (letter("/\\") || is(Key::Kind::function, 3) || is(Key::Kind::function, 4)) {
    filter_before_ = std::exchange(filter_, {});
    typing_ = true;
  } else if (is(Key::Kind::escape)) {
    filter_.clear();
  } else if (letter("a")) {
    all_ = !all_;
  } else if (letter("<>") || is(Key::Kind::function, 6)) {
    const std::size_t count = sorts.size();
    const std::size_t step = letter("<") ? count - 1 : 1;
    sort_ = static_cast<Sort>((static_cast<std::size_t>(sort_) + step) % count);
  } else if (letter("I")) {
    reversed_ = !reversed_;
  } else if (is(Key::Kind::down) || letter("j")) {
    move_by(1);
  } else if (is(Key::Kind::up) || letter("k")) {
    move_by(-1);
  } else if (is(Key::Kind::page_down)) {
    move_by(page);
  } else if (is(Key::Kind::page_up)) {
    move_by(-page);
  } else if (is(Key::Kind::home) || letter("g")) {
    move_to(0);
  } else if (is(Key::Kind::end) || letter("G")) {
    move_to(order_.size());
  } else if (letter("*")) {
    const bool any = !open_.empty();
    open_.clear();
    for (const Place& place : order_)
      if (!any && place.topic != nullptr) open_.insert({place.key.bus, place.key.row});
  } else if (is(Key::Kind::click) && key.number >= list_at_ && key.number < list_at_ + list_lines_) {
    if (first_ + key.number - list_at_ < order_.size()) move_to(first_ + key.number - list_at_);
  } else if (!order_.empty() && (letter(" +-") || is(Key::Kind::enter))) {
    const Place place = order_[cursor_index()];
    const std::pair<std::size_t, std::size_t> row{place.key.bus, place.key.row};
    cursor_ = place.key;
    if (letter(" "))
      pick(place);
    else if (letter("-") || (!letter("+") && open_.contains(row)))
      open_.erase(row);
    else if (place.topic != nullptr)
      open_.insert(row);
  }
  return {};
}

}  // namespace ocm::cli::top
