// The world on a terminal: how often it is looked at and drawn.
#include "cli/simulate/text_show.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <unistd.h>

#include <catch2/catch.hpp>

#include "cli/shared/clock.hpp"
#include "cli/top/curses.hpp"
#include "tests/tool/pseudo_terminal.hpp"
#include "tests/unit/host/host_testing.hpp"

namespace simulate_text_show_test {

using namespace std::chrono_literals;
using namespace ocm;
using namespace ocm::test;
using cli::Clock;

/// From before the first picture until the second one is there, in ms, 250 at most; 0: it cannot draw. In a
/// process of its own, whose terminal it is.
int until_the_second_picture(bool presses_keys) {
  const PseudoTerminal terminal;
  return in_child([&] {
    try {
      ::dup2(terminal.descriptor(), STDIN_FILENO);
      ::dup2(terminal.descriptor(), STDOUT_FILENO);
      ::setenv("TERM", "xterm", 1);
      const cli::Session session;
      cli::simulate::TextShow show{session, {}};
      int looks = 0;
      const auto look = [&looks] {
        ++looks;
        return sim::SeenWorld{};
      };
      const auto begin = Clock::now();
      while (looks < 2) {
        if (presses_keys) terminal.press("b");
        show.watch(look);
        ::usleep(100);
      }
      return static_cast<int>(std::min<std::int64_t>((Clock::now() - begin) / 1ms, 250));
    } catch (...) {
      return 0;
    }
  });
}

TEST_CASE("text show: it draws ten pictures a second, and no more than twenty where keys are pressed") {
  if (!cli::top::has_curses) return;
  CHECK(until_the_second_picture(false) >= 100);
  CHECK(until_the_second_picture(true) >= 50);
}

}  // namespace simulate_text_show_test
