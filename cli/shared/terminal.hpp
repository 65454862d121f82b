/// The size of a terminal, for what is shown there again and again in place: a line that breaks stays behind.
#pragma once

#include <cstddef>
#include <sys/ioctl.h>

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

}  // namespace ocm::cli
