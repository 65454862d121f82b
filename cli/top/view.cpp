#include "cli/top/view.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "ocm/base/utf8.hpp"
#include "ocm/client/counted.hpp"

#include "cli/top/short_number.hpp"

namespace ocm::cli::top {
namespace {

bool contains(std::string_view text, std::string_view part) {
  const auto same = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
  };
  return std::search(text.begin(), text.end(), part.begin(), part.end(), same) != text.end();
}

/// `right` columns beside it are for what follows.
void load_bar(LineWriter& line, double load, std::size_t right) {
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

}  // namespace

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
    if (!row.has_bytes()) continue;
    const bool open = open_.contains({bus, row.number});
    for (std::size_t frame = 0; frame < row.topic->frames.size(); ++frame) {
      const auto& layout = row.topic->frames[frame];
      const auto data = row.newest.data(frame);
      for (std::size_t field = 0; field < layout.values().size(); ++field) {
        ItemKey of_field = key;
        of_field.frame = static_cast<int>(frame);
        of_field.field = static_cast<int>(field);
        const bool known = layout.has(layout.values()[field], data) || seen_.contains(of_field);
        if ((open && known) || graphs_.contains(of_field)) items.push_back({of_field, &row});
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
  LineWriter title{width};
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
    LineWriter line{width};
    if (scene.buses.size() > 1) line.put(left(bus.name, name) + ' ', Style::bold);
    const std::string rate = fmt::format("{} frames/s", short_number(sum.rate_hz));
    if (sum.load_known) load_bar(line, sum.load, rate.size());
    if (!line.put_whole(rate)) line.put(std::string(line.room(), ' '));  // what follows is worth less
    if (sum.load_known)
      line.put_whole(fmt::format("  worst {}", percent(sum.worst_load)), Style::dim);
    else
      line.put_whole("  for its load: --bitrate 500k", Style::dim);
    picture.push_back(line.take());

    LineWriter counters{width};
    if (sum.controller)
      counters.put_whole(fmt::format("{}  ", can::name(*sum.controller)), style_of(*sum.controller));
    if (sum.error_counters)
      counters.put_whole(
          fmt::format("TEC {} REC {}  ", sum.error_counters->transmit, sum.error_counters->receive),
          sum.controller ? style_of(*sum.controller) : Style::dim);
    counters.put_whole(client::counted(sum.frames, "frame"), Style::dim);
    const auto count = [&](std::uint64_t number, std::string_view what, Style bad) {
      if (number > 0) counters.put_whole(fmt::format("  {} {}", number, what), bad);
    };
    count(sum.errors, sum.errors == 1 ? "error frame" : "error frames", Style::bad);
    count(sum.overflows, sum.overflows == 1 ? "overflow" : "overflows", Style::bad);
    count(sum.lost, "lost", Style::bad);
    count(sum.incomplete, "incomplete", Style::warning);
    count(sum.wrong_length, "of a wrong length", Style::warning);
    count(sum.unknown, "unknown", Style::dim);
    count(sum.transport, sum.transport == 1 ? "message put together" : "messages put together", Style::dim);
    count(sum.transport_lost, "not put together", Style::warning);
    count(sum.not_shown, "of more identifiers than are shown", Style::warning);
    count(sum.not_in_load, "CAN FD, not in the load", Style::dim);
    picture.push_back(counters.take());
  }
}

Line View::foot(const Scene& scene, std::size_t width) const {
  LineWriter line{width};
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
  LineWriter line{width};
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
  if (all.empty()) {
    LineWriter line{size.columns};
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

}  // namespace ocm::cli::top
