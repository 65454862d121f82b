/// A line as several that fit a terminal: broken between words, and never within one, so that a number stays
/// whole. A word that is longer than the terminal is wide stays as it is.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

#include "ocm/base/utf8.hpp"

namespace ocm::cli {

/// What a text takes on a terminal. Sequences of colours (ESC [ ... m) take nothing.
struct Extent {
  std::size_t all = 0;    ///< columns
  std::size_t words = 0;  ///< the same without the blanks at its end
};

[[nodiscard]] inline Extent extent(std::string_view text) noexcept {
  Extent found;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\x1b') {
      i = std::min(text.find('m', i), text.size());
      continue;
    }
    if (base::continues_character(text[i])) continue;
    ++found.all;
    if (text[i] != ' ') found.words = found.all;
  }
  return found;
}

/// Puts pieces of a line one behind the other, each on a new line where it does not fit any more.
class Folding {
 public:
  /// Lines after the first begin with `indent` blanks.
  Folding(std::size_t columns, std::size_t indent)
      : columns_(columns), indent_(indent + min_room > columns ? 0 : indent) {}

  /// Stays in one line if a line has room for it; otherwise it is broken at blanks and behind '|'.
  void add(std::string_view piece) {
    if (indent_ + extent(piece).words <= columns_) return put(piece);
    while (!piece.empty()) {
      const std::size_t size = word(piece);
      put(piece.substr(0, size));
      piece.remove_prefix(size);
    }
  }
  void new_line() {
    text_.erase(text_.find_last_not_of(' ') + 1);
    text_ += '\n';
    text_.append(indent_, ' ');
    used_ = indent_;
    fresh_ = true;
  }
  /// Without an end of line.
  [[nodiscard]] const std::string& text() const noexcept { return text_; }

 private:
  static constexpr std::size_t min_room = 16;  ///< less than this beside the indent helps no reader

  void put(std::string_view piece) {
    if (used_ != 0 && !fresh_ && used_ + extent(piece).words > columns_) new_line();
    if (used_ == 0 || fresh_) return begin_with(piece);
    text_ += piece;
    used_ += extent(piece).all;
  }
  /// The first of a line. What does not fit behind the indent, but without it, is moved to the left.
  void begin_with(std::string_view piece) {
    const std::size_t blanks = std::min(piece.find_first_not_of(' '), piece.size());
    const std::string_view words = piece.substr(blanks);
    if (fresh_ && words.empty()) return;
    const std::size_t before = fresh_ ? indent_ : blanks;
    const std::size_t room = columns_ - std::min(columns_, extent(words).words);
    text_.resize(text_.size() - used_);
    text_.append(std::min(before, room), ' ').append(words);
    used_ = std::min(before, room) + extent(words).all;
    fresh_ = false;
  }
  /// The size of the first word, with the blanks before it.
  static std::size_t word(std::string_view text) {
    const std::size_t begin = std::min(text.find_first_not_of(' '), text.size());
    const std::size_t end = text.find_first_of(" |", begin);
    if (end == std::string_view::npos) return text.size();
    return text[end] == '|' ? end + 1 : end;
  }

  std::size_t columns_;
  std::size_t indent_;
  std::string text_;
  std::size_t used_ = 0;
  bool fresh_ = false;  ///< at the beginning of a line that is not the first
};

/// A line as it is where it fits; otherwise broken at blanks.
[[nodiscard]] inline std::string folded(std::string_view line, std::size_t columns, std::size_t indent) {
  if (extent(line).words <= columns) return std::string{line};
  Folding folding{columns, indent};
  // The blanks that it begins with belong to its first word.
  while (!line.empty()) {
    const std::size_t word = line.find_first_not_of(' ');
    const std::size_t end =
        word == std::string_view::npos ? line.size() : std::min(line.find(' ', word), line.size());
    folding.add(line.substr(0, end));
    line.remove_prefix(end);
  }
  return folding.text();
}

/// A line of the help: what it describes, two blanks or more, the description. The lines of a description are
/// below each other, or below the words that it describes where a terminal has no room beside them.
[[nodiscard]] inline std::string folded_help(std::string_view line, std::size_t columns) {
  if (extent(line).words <= columns) return std::string{line};
  constexpr std::size_t least = 24;  // columns of a description
  const std::size_t lead = std::min(line.find_first_not_of(' '), line.size());
  // An option that fills its column has one blank behind it.
  constexpr std::size_t column = 28;
  const bool filled = line.size() > lead + column && line[lead] == '-' && line[lead + column - 2] != ' ' &&
                      line[lead + column - 1] == ' ' && line[lead + column] != ' ';
  const std::size_t gap = filled ? lead + column - 1 : std::min(line.find("  ", lead), line.size());
  const std::size_t second = std::min(line.find_first_not_of(' ', gap), line.size());
  if (lead + least > columns) {
    constexpr std::size_t below = 6;
    return folded(std::string(below, ' ') + std::string{line.substr(lead)}, columns, below);
  }
  if (second == line.size()) return folded(line, columns, lead < column ? lead + 2 : lead);
  if (second + least <= columns) return folded(line, columns, second);
  std::string text = folded(line.substr(0, gap), columns, lead + 2);
  const std::string blanks(std::min<std::size_t>(lead + 4, 6), ' ');
  return text + '\n' + folded(blanks + std::string{line.substr(second)}, columns, blanks.size());
}

}  // namespace ocm::cli
