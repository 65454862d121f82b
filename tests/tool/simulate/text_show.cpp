// The world on a terminal: how often it is looked at and drawn, and what is drawn there.
#include "cli/simulate/text_show.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <sys/types.h>
#include <unistd.h>

#include <catch2/catch.hpp>

#include "cli/shared/clock.hpp"
#include "cli/shared/messages.hpp"
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

/// What act(show, terminal) answers with a show, in a process of its own, whose terminal it is; 0: it cannot
/// draw. The terminal has letters only, and no other way to write several.
template <class Act>
int with_a_show(Act&& act) {
  const PseudoTerminal terminal;
  return in_child([&] {
    try {
      for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        ::dup2(terminal.descriptor(), stream);
      ::setenv("TERM", "vt100", 1);
      ::setenv("LC_ALL", "C", 1);
      const cli::Session session;
      cli::simulate::TextShow show{session, {.speed = 2, .bus = "can7"}};
      return static_cast<int>(act(show, terminal));
    } catch (...) {
      return 0;
    }
  });
}

/// All that was written to it since it was asked last.
std::string written_to(const PseudoTerminal& terminal) {
  constexpr std::string_view end = "<end>";
  REQUIRE(::write(terminal.descriptor(), end.data(), end.size()) == static_cast<ssize_t>(end.size()));
  return terminal.shown(end);
}

/// A robot in a hall of 2 m by 1 m.
sim::SeenWorld hall(double x_m) {
  sim::SeenWorld world{"hall", base::Time{}};
  const sim::Vector corners[] = {{0, 0}, {2, 0}, {2, 1}, {0, 1}};
  for (int i = 0; i < 4; ++i) world.walls.push_back({corners[i], corners[(i + 1) % 4]});
  world.robots.push_back({"AVR", {x_m, 0.5, 0}, {x_m, 0.5}, 0.1, {}});
  return world;
}

TEST_CASE("text show: a trail is drawn where the robot was, and the key t begins a new one") {
  if (!cli::top::has_curses) return;
  const auto draws_trail = [](bool begins_new_one) {
    const int answer = with_a_show([&](cli::simulate::TextShow& show, const PseudoTerminal& terminal) {
      int looks = 0;
      const auto look = [&looks] { return hall(looks++ == 0 ? 0.2 : 1.8); };
      show.watch(look);
      static_cast<void>(written_to(terminal));
      if (begins_new_one) terminal.press("t");
      while (looks < 2) {
        show.watch(look);
        ::usleep(100);
      }
      return written_to(terminal).find("....") != std::string::npos ? 1 : 2;
    });
    REQUIRE(answer != 0);
    return answer == 1;
  };
  CHECK(draws_trail(false));
  CHECK_FALSE(draws_trail(true));
}

TEST_CASE(
    "text show: the newest message has the last line, the keys have it before, and the first says where") {
  if (!cli::top::has_curses) return;
  const auto draws = [](std::string_view words, bool has_message) {
    const int answer = with_a_show([&](cli::simulate::TextShow& show, const PseudoTerminal& terminal) {
      if (has_message) {
        cli::remark("went-down");
        cli::remark("went-up");
      }
      show.watch([] { return hall(1); });
      return written_to(terminal).find(words) != std::string::npos ? 1 : 2;
    });
    REQUIRE(answer != 0);
    return answer == 1;
  };
  CHECK(draws("went-up", true));
  CHECK_FALSE(draws("went-down", true));
  CHECK_FALSE(draws("quit", true));
  CHECK(draws("quit", false));
  CHECK(draws("x2", false));
  CHECK(draws("can7", false));
}

}  // namespace simulate_text_show_test
