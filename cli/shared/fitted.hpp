/// Text of several lines as it fits the terminal that stdout is: its lines are broken between words, and
/// never within a number. Where stdout is no terminal, or does not say how wide it is, lines stay as they
/// are: programs read them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "cli/shared/folding.hpp"
#include "cli/shared/terminal.hpp"

namespace ocm::cli {

/// Each line in so many columns; those after its first begin with `indent` blanks.
[[nodiscard]] inline std::string fitted(std::string_view text, std::size_t columns, std::size_t indent) {
  std::string out;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    out += folded(text.substr(0, end), columns, indent);
    if (end < text.size()) out += '\n';
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

inline void print_fitted(std::string_view text, std::size_t indent) {
  fmt::print("{}", fitted(text, columns_of_output(), indent));
}

}  // namespace ocm::cli
