// What a key does, and the page that says so.
#include <algorithm>
#include <utility>

#include "ocm/base/utf8.hpp"

#include "cli/shared/folding.hpp"
#include "cli/top/view.hpp"

namespace ocm::cli::top {
namespace {

using namespace std::chrono_literals;

}  // namespace

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
      LineWriter line{size.columns};
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
