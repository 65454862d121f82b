/// Lines as a terminal shows them: pieces of text, each in a style, and what fills a line up to its width.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ocm/base/utf8.hpp"

namespace ocm::cli::top {

enum class Style : std::uint8_t { plain, dim, bold, heading, sorted, selected, good, warning, bad };

struct Piece {
  std::string text;
  Style style = Style::plain;
};
using Line = std::vector<Piece>;
/// As many lines as the terminal has, none wider than it.
using Picture = std::vector<Line>;

/// Puts pieces behind each other, as far as there is room.
class LineWriter {
 public:
  explicit LineWriter(std::size_t width) : width_(width) {}

  [[nodiscard]] std::size_t room() const noexcept { return width_ - used_; }
  [[nodiscard]] std::size_t used() const noexcept { return used_; }

  /// Cut at the end of the line.
  void put(std::string_view text, Style style = Style::plain);
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

/// A text in exactly so many columns: cut, or with spaces behind it.
[[nodiscard]] std::string left(std::string_view text, std::size_t width);
/// With spaces before it up to so many columns; a longer text is whole.
[[nodiscard]] std::string right(std::string_view text, std::size_t width);

}  // namespace ocm::cli::top
