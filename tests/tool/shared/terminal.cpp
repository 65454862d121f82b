// What a terminal says of its size, and what counts where it says nothing.
#include "cli/shared/terminal.hpp"

#include <array>
#include <cstdint>
#include <cstdlib>
#include <fcntl.h>
#include <optional>
#include <string>
#include <sys/ioctl.h>
#include <unistd.h>

#include <catch2/catch.hpp>

#include "ocm/host/descriptor.hpp"

#include "tests/tool/pseudo_terminal.hpp"

namespace tool_shared_terminal_test {

using namespace ocm;
using test::PseudoTerminal;

/// Columns and rows to draw in, and the columns that lines are broken for.
using Size = std::array<std::size_t, 3>;

Size size_of(int descriptor) {
  const cli::TerminalSize size = cli::terminal_size(descriptor);
  return {size.columns, size.rows, cli::columns_of(descriptor)};
}

TEST_CASE("terminal: its size, or the usual one where it does not say, or has no room") {
  const PseudoTerminal terminal;
  const auto with = [&terminal](unsigned short columns, unsigned short rows) {
    winsize size{};
    size.ws_col = columns;
    size.ws_row = rows;
    REQUIRE(::ioctl(terminal.descriptor(), TIOCSWINSZ, &size) == 0);
    return size_of(terminal.descriptor());
  };
  CHECK(with(0, 0) == Size{80, 24, SIZE_MAX});
  CHECK(with(0, 50) == Size{80, 24, SIZE_MAX});
  CHECK(with(1, 50) == Size{1, 50, 1});
  CHECK(with(132, 2) == Size{132, 2, 132});
  CHECK(with(132, 1) == Size{80, 24, 132});
}

TEST_CASE("terminal: a pipe has no size") {
  std::array<int, 2> ends{};
  REQUIRE(::pipe2(ends.data(), O_CLOEXEC) == 0);
  const host::Descriptor out{ends[0]}, in{ends[1]};
  CHECK(size_of(in.get()) == Size{80, 24, SIZE_MAX});
  CHECK_FALSE(cli::can_redraw(in.get()));
}

TEST_CASE("terminal: a line can be drawn again, but where TERM says that there are no control sequences") {
  const PseudoTerminal terminal;
  const char* const now = std::getenv("TERM");
  const auto before = now != nullptr ? std::optional<std::string>{now} : std::nullopt;
  const auto with = [&terminal](const char* term) {
    if (term != nullptr)
      ::setenv("TERM", term, 1);
    else
      ::unsetenv("TERM");
    return cli::can_redraw(terminal.descriptor());
  };
  CHECK(with("xterm"));
  CHECK(with("dumber"));
  CHECK(with(nullptr));
  CHECK_FALSE(with("dumb"));
  static_cast<void>(with(before ? before->c_str() : nullptr));
}

}  // namespace tool_shared_terminal_test
