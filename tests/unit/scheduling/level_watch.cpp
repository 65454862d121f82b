#include "ocm/scheduling/level_watch.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <optional>

#include <catch2/catch.hpp>

#include "ocm/scheduling/cooperative.hpp"
#include "ocm/scheduling/dispatcher.hpp"

namespace scheduling_level_watch_test {

using namespace ocm;
using namespace ocm::scheduling;
using namespace std::chrono_literals;

constexpr std::array levels{Level::urgent, Level::high, Level::medium, Level::low};

constexpr bool fed_only_by_all() {
  LevelWatch watch{100ms};
  if (watch.complete()) return false;
  for (const Level level : levels) {
    watch.ran(level);
    watch.ran(level);  // twice is no substitute for another level
    if (watch.complete() != (level == Level::low)) return false;
  }
  return !watch.complete();  // all again
}
static_assert(fed_only_by_all());

TEST_CASE("the watchdog is fed when every level has run since the last time, whatever their order") {
  auto order = levels;
  do {
    LevelWatch watch{100ms};
    for (std::size_t i = 0; i < order.size(); ++i) {
      CHECK_FALSE(watch.complete());
      watch.ran(order[i]);
    }
    CHECK(watch.complete());
    CHECK_FALSE(watch.complete());
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST_CASE("a level that stopped is missed, whichever it is") {
  for (const Level stopped : levels) {
    LevelWatch watch{100ms};
    for (const Level level : levels) watch.ran(level);
    REQUIRE(watch.complete());
    for (int round = 0; round < 10; ++round) {
      for (const Level level : levels)
        if (level != stopped) watch.ran(level);
      CHECK_FALSE(watch.complete());
    }
    watch.ran(stopped);
    CHECK(watch.complete());
  }
}

TEST_CASE("the levels are called up at once, then once a period, and not for each period that was missed") {
  LevelWatch watch{100ms};
  const base::Time start{5s};
  CHECK(watch.due(start));
  CHECK_FALSE(watch.due(start));
  CHECK_FALSE(watch.due(start + 99ms));
  CHECK(watch.due(start + 100ms));
  CHECK_FALSE(watch.due(start + 199ms));
  CHECK(watch.due(start + 950ms));
  CHECK_FALSE(watch.due(start + 960ms));
}

/// A port that watches its levels.
class WatchingPort : public Cooperative {
 public:
  void ran(Level level) noexcept { watch.ran(level); }
  LevelWatch watch{100ms};
};
static_assert(LevelWatcher<WatchingPort>);
static_assert(!LevelWatcher<Cooperative>);

/// A board in virtual time, whose lowest level looks at the watch every 10 ms.
class Board {
 public:
  /// How often the watchdog is fed in `time`, and the longest that it waits for that. `stuck`: this level's
  /// job never comes back; nor is a level below it run, as `starves` says.
  struct Fed {
    int times = 0;
    base::Duration longest{};
  };
  Fed let_pass(base::Duration time, std::optional<Level> stuck = {}, bool starves = false) {
    Fed fed;
    base::Time last = port_.now();
    for (const base::Time end = port_.now() + time; port_.now() < end; port_.advance(port_.now() + 10ms)) {
      if (port_.armed() <= port_.now()) {
        port_.arm(base::never);
        dispatcher_.expire();
      }
      const bool low_runs = !starves || !stuck;
      if (low_runs && port_.watch.due(port_.now()))
        for (const Level level : levels) port_.pend(level);
      for (Level level{}; port_.take_pended(level);)
        if (!stuck || (level != *stuck && (level < *stuck || !starves)))
          dispatcher_.run(level, [](const Release&) { return Outcome::done; });
      if (low_runs && port_.watch.complete()) {
        ++fed.times;
        last = port_.now();
      }
      fed.longest = std::max(fed.longest, port_.now() - last);
    }
    return fed;
  }
  void publish(std::size_t stream, base::Duration period, Level level) {
    dispatcher_.start(stream, period, level, port_.now());
  }

 private:
  WatchingPort port_;
  Dispatcher<2, WatchingPort> dispatcher_{port_};
};

TEST_CASE("a board without anything to do feeds its watchdog once a period") {
  const auto fed = Board{}.let_pass(10s);
  CHECK(fed.times == 100);
  CHECK(fed.longest <= 100ms);
}

TEST_CASE("a busy board feeds it as well, whichever levels have work") {
  Board board;
  board.publish(0, 10ms, Level::urgent);
  board.publish(1, 30ms, Level::medium);
  const auto fed = board.let_pass(10s);
  CHECK(fed.times == 100);
  CHECK(fed.longest <= 100ms);
}

TEST_CASE("one job that does not come back, and the watchdog is not fed any more") {
  for (const Level stuck : levels) {
    for (const bool starves : {false, true}) {
      Board board;
      board.publish(0, 10ms, Level::high);
      REQUIRE(board.let_pass(1s).times == 10);
      const auto fed = board.let_pass(2s, stuck, starves);
      CHECK(fed.times <= 1);  // what the level proved before
      CHECK(fed.longest > 1800ms);
    }
  }
}

TEST_CASE("a level that is never out of work proves itself before each job") {
  WatchingPort port;
  Dispatcher<1, WatchingPort> dispatcher{port};
  dispatcher.start(0, 10ms, Level::high, port.now());
  dispatcher.expire();
  int jobs = 0;
  int fed = 0;
  dispatcher.run(Level::high, [&](const Release&) {  // takes longer than its period, a hundred times
    for (const Level level : {Level::urgent, Level::medium, Level::low}) port.ran(level);
    if (port.watch.complete()) ++fed;
    port.advance(port.now() + 15ms);
    dispatcher.expire();
    if (++jobs == 100) dispatcher.stop(0);
    return Outcome::done;
  });
  CHECK(jobs == 100);
  CHECK(fed == 100);
}

}  // namespace scheduling_level_watch_test
