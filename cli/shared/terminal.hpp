/// The size of a terminal: what is shown there fits its width, and in its height where it is drawn again in
/// place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <sys/ioctl.h>
#include <unistd.h>

namespace ocm::cli {

struct TerminalSize {
  std::size_t columns = 80;
  std::size_t rows = 24;
};

/// Of the terminal that `descriptor` is; 80 columns and 24 rows if it does not say.
[[nodiscard]] inline TerminalSize terminal_size(int descriptor) noexcept {
  winsize size{};
  if (::ioctl(descriptor, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row < 2) return {};
  return {size.ws_col, size.ws_row};
}

/// Whether a line there can be erased and written again: a terminal, and not one without control sequences
/// (TERM=dumb).
[[nodiscard]] inline bool can_redraw(int descriptor) noexcept {
  const char* const term = std::getenv("TERM");
  return isatty(descriptor) != 0 && (term == nullptr || std::string_view{term} != "dumb");
}

/// How many columns the terminal behind `descriptor` has; SIZE_MAX: the descriptor leads to no terminal, or
/// the terminal does not report its size.
[[nodiscard]] inline std::size_t columns_of(int descriptor) noexcept {
  winsize size{};
  const bool said = isatty(descriptor) != 0 && ::ioctl(descriptor, TIOCGWINSZ, &size) == 0;
  return said && size.ws_col != 0 ? size.ws_col : SIZE_MAX;
}
[[nodiscard]] inline std::size_t columns_of_output() noexcept {
  return columns_of(STDOUT_FILENO);
}

}  // namespace ocm::cli
