#include "ocm/scheduling/dispatcher.hpp"

#include <functional>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/scheduling/cooperative.hpp"

namespace scheduling_dispatcher_test {

using namespace ocm;
using namespace std::chrono_literals;
using scheduling::Cooperative;
using scheduling::Dispatcher;
using scheduling::Level;
using scheduling::Outcome;
using scheduling::Overload;
using scheduling::Release;

constexpr base::Time at(base::Duration offset) {
  return base::Time{offset};
}

/// Counts what is asked of the port, and sees that it is asked with the lock held and never twice.
struct Port : Cooperative {
  struct Guard {
    explicit Guard(Port& p) : port(&p) {
      port->bad += port->locked ? 1 : 0;
      port->locked = true;
      ++port->locks;
    }
    ~Guard() { port->locked = false; }
    Guard(const Guard&) = delete;
    Guard& operator=(const Guard&) = delete;
    Port* port;
  };
  Guard lock() { return Guard{*this}; }
  void arm(base::Time when) {
    bad += locked ? 0 : 1;
    ++arms;
    Cooperative::arm(when);
  }
  void pend(Level level) {
    bad += locked ? 0 : 1;
    Cooperative::pend(level);
  }
  bool locked = false;
  int bad = 0;
  int arms = 0;
  int locks = 0;
};

struct Setup {
  Port port;
  Dispatcher<4, Port> dispatcher{port};
  std::vector<Release> releases;
  std::function<Outcome(const Release&)> job = [](const Release&) { return Outcome::done; };

  void pass_to(base::Duration time) {
    for (;;) {
      work();
      if (port.armed() > at(time)) break;
      port.advance(port.armed());
      port.Cooperative::arm(base::never);
      dispatcher.expire();
    }
    port.advance(at(time));
    CHECK(port.bad == 0);
  }
  void work() {
    for (Level level; port.take_pended(level);)
      dispatcher.run(level, [this](const Release& release) {
        releases.push_back(release);
        return job(release);
      });
  }
};

static_assert(sizeof(Dispatcher<7, Cooperative>) == 7 * 40 + 24);

TEST_CASE("a stream is released at once, then on its grid, and the timer is armed once a release") {
  Setup setup;
  setup.port.advance(at(3ms));
  setup.dispatcher.start(1, 10ms, Level::high, at(3ms));
  CHECK(setup.port.armed() == base::never);  // due now: nothing to wait for
  setup.pass_to(100ms);
  REQUIRE(setup.releases.size() == 10);
  for (std::size_t i = 0; i < 10; ++i) {
    CHECK(setup.releases[i].scheduled == at(3ms + 10ms * i));
    CHECK(setup.releases[i].stream == 1);
    CHECK(setup.releases[i].level == Level::high);
  }
  CHECK(setup.port.arms == 10);
  CHECK(setup.dispatcher.active() == 1);
}

TEST_CASE("levels are pended as their streams fall due, all of them") {
  Setup setup;
  setup.dispatcher.start(0, 10ms, Level::low, at(0ms));
  setup.dispatcher.start(1, 20ms, Level::urgent, at(0ms));
  setup.dispatcher.start(2, 20ms, Level::low, at(0ms));
  setup.pass_to(20ms);
  std::vector<std::size_t> order;
  for (const auto& release : setup.releases) order.push_back(release.stream);
  CHECK(order == std::vector<std::size_t>{1, 0, 2, 0, 1, 0, 2});
}

TEST_CASE("a stop prevents every release after it, also one that is due and pended") {
  Setup setup;
  setup.dispatcher.start(0, 10ms, Level::low, at(0ms));
  setup.pass_to(9ms);
  setup.port.advance(at(10ms));
  setup.dispatcher.expire();
  REQUIRE(setup.port.pended());
  setup.dispatcher.stop(0);
  setup.pass_to(1s);
  CHECK(setup.releases.size() == 1);
  CHECK(setup.dispatcher.next_release() == base::never);
}

TEST_CASE("what is asked for while a job runs acts from its next release") {
  Setup setup;
  int inside = 0;
  setup.job = [&](const Release& release) {
    CHECK(++inside == 1);  // never in two contexts
    if (release.scheduled == at(0ms)) {
      setup.port.advance(at(4ms));
      setup.dispatcher.start(0, 7ms, Level::urgent, at(4ms));
      Release other;
      CHECK_FALSE(setup.dispatcher.take(Level::urgent, other));
    }
    --inside;
    return Outcome::done;
  };
  setup.dispatcher.start(0, 10ms, Level::low, at(0ms));
  setup.pass_to(12ms);
  REQUIRE(setup.releases.size() == 3);
  CHECK(setup.releases[0].level == Level::low);
  CHECK(setup.releases[1].level == Level::urgent);
  CHECK(setup.releases[1].scheduled == at(4ms));
  CHECK(setup.releases[2].scheduled == at(11ms));
}

TEST_CASE("a stop from within the job, and a single release from within it") {
  Setup setup;
  setup.job = [&](const Release& release) {
    if (release.stream == 0) setup.dispatcher.stop(0);
    if (release.stream == 1 && release.scheduled == at(0ms)) setup.dispatcher.once(1, Level::high, at(30ms));
    return Outcome::done;
  };
  setup.dispatcher.start(0, 10ms, Level::low, at(0ms));
  setup.dispatcher.start(1, 10ms, Level::low, at(0ms));
  setup.pass_to(1s);
  REQUIRE(setup.releases.size() == 3);
  CHECK(setup.releases[2].stream == 1);
  CHECK(setup.releases[2].scheduled == at(30ms));
}

TEST_CASE("a single release that is asked for beside a stream leaves the stream as it is") {
  Setup setup;
  setup.dispatcher.start(2, 20ms, Level::medium, at(0ms));
  setup.pass_to(0ms);
  setup.dispatcher.once_unless_active(2, Level::urgent, at(5ms));
  setup.pass_to(40ms);
  CHECK(setup.releases.size() == 3);  // 0, 20, 40
  setup.dispatcher.stop(2);
  setup.dispatcher.once_unless_active(2, Level::urgent, at(45ms));
  setup.pass_to(80ms);
  REQUIRE(setup.releases.size() == 4);
  CHECK(setup.releases[3].scheduled == at(45ms));
  CHECK(setup.port.bad == 0);
}

TEST_CASE("an alarm is a single release that lies ahead, and can be moved both ways") {
  Setup setup;
  setup.dispatcher.once(3, Level::urgent, at(50ms));
  setup.dispatcher.once(3, Level::urgent, [] { return at(70ms); });
  setup.pass_to(60ms);
  CHECK(setup.releases.empty());
  setup.dispatcher.once(3, Level::urgent, at(65ms));
  setup.pass_to(66ms);
  REQUIRE(setup.releases.size() == 1);
  CHECK(setup.releases[0].scheduled == at(65ms));
  setup.dispatcher.once(3, Level::urgent, at(80ms));
  setup.dispatcher.once(3, Level::urgent, [] { return base::never; });
  setup.pass_to(1s);
  CHECK(setup.releases.size() == 1);
}

TEST_CASE("what waits is resumed by the level that began it, before anything new") {
  Setup setup;
  bool room = false;
  setup.job = [&](const Release&) { return room ? Outcome::done : Outcome::waits; };
  setup.dispatcher.start(0, 10ms, Level::low, at(0ms));
  setup.pass_to(1ms);
  CHECK(setup.dispatcher.waiting());
  setup.dispatcher.start(0, 10ms, Level::urgent, at(2ms));
  setup.pass_to(25ms);
  CHECK(setup.releases.size() == 1);
  CHECK(setup.dispatcher.overload(0) == Overload{0, 0, 3});  // 2, 12, 22
  setup.dispatcher.wake();
  setup.pass_to(26ms);  // still no room
  CHECK(setup.releases.size() == 2);
  room = true;
  setup.dispatcher.wake();
  setup.pass_to(40ms);
  REQUIRE(setup.releases.size() == 4);
  CHECK(setup.releases[2].resumed);
  CHECK(setup.releases[2].level == Level::low);
  CHECK_FALSE(setup.releases[3].resumed);
  CHECK(setup.releases[3].level == Level::urgent);
  CHECK(setup.releases[3].scheduled == at(32ms));
  CHECK_FALSE(setup.dispatcher.waiting());
  CHECK(setup.dispatcher.overload(0).overrun == 3);
}

TEST_CASE("all that wait on a level are resumed, each once") {
  Setup setup;
  bool room = false;
  setup.job = [&](const Release&) { return room ? Outcome::done : Outcome::waits; };
  for (const std::size_t stream : {std::size_t{0}, std::size_t{2}, std::size_t{3}})
    setup.dispatcher.once(stream, Level::low, [] { return at(0ms); });
  setup.pass_to(1ms);
  CHECK(setup.releases.size() == 3);
  room = true;
  setup.dispatcher.wake();
  setup.pass_to(2ms);
  REQUIRE(setup.releases.size() == 6);
  for (std::size_t i = 3; i < 6; ++i) CHECK(setup.releases[i].resumed);
  CHECK(setup.releases[3].stream == 0);
  CHECK(setup.releases[4].stream == 2);
  CHECK(setup.releases[5].stream == 3);
  CHECK_FALSE(setup.dispatcher.waiting());
}

TEST_CASE("room that comes between a job's look and its end is not overlooked") {
  Setup setup;
  int calls = 0;
  setup.job = [&](const Release&) {
    if (++calls > 1) return Outcome::done;
    setup.dispatcher.wake();  // an interrupt, after the job found no room
    return Outcome::waits;
  };
  setup.dispatcher.once(0, Level::medium, at(0ms));
  setup.pass_to(1ms);
  CHECK(calls == 2);
  CHECK_FALSE(setup.dispatcher.waiting());
}

TEST_CASE("a timer that goes off early or for nothing does no harm") {
  Setup setup;
  setup.dispatcher.start(0, 10ms, Level::low, at(0ms));
  setup.pass_to(5ms);
  for (int i = 0; i < 5; ++i) {
    setup.dispatcher.expire();
    CHECK(setup.port.armed() == at(10ms));
  }
  setup.pass_to(10ms);
  CHECK(setup.releases.size() == 2);
  setup.dispatcher.stop(0);
  setup.pass_to(1s);
  CHECK(setup.releases.size() == 2);
}

TEST_CASE("the streams that publish are counted, from the first to the last") {
  Setup setup;
  CHECK(setup.dispatcher.active() == 0);
  setup.dispatcher.start(0, 10ms, Level::low, at(0ms));
  setup.dispatcher.start(3, 10ms, Level::urgent, at(0ms));
  setup.dispatcher.once(1, Level::low, at(50ms));  // is no publisher
  CHECK(setup.dispatcher.active() == 2);
  CHECK(setup.dispatcher.active(0));
  CHECK_FALSE(setup.dispatcher.active(1));
  CHECK(setup.dispatcher.active(3));
  setup.dispatcher.stop(0);
  CHECK(setup.dispatcher.active() == 1);
}

TEST_CASE("what waits is known on each level, and what is resumed is neither late nor has it missed any") {
  for (const Level level : {Level::urgent, Level::high, Level::medium, Level::low}) {
    Setup setup;
    bool room = false;
    setup.job = [&](const Release&) { return room ? Outcome::done : Outcome::waits; };
    setup.dispatcher.start(2, 10ms, level, at(0ms), 1ms);
    CHECK_FALSE(setup.dispatcher.waiting());
    setup.pass_to(45ms);
    CHECK(setup.dispatcher.waiting());
    setup.dispatcher.stop(2);
    room = true;
    setup.dispatcher.wake();
    setup.pass_to(46ms);
    REQUIRE(setup.releases.size() == 2);
    CHECK(setup.releases[1] == Release{2, level, {}, 0, false, true});
    CHECK_FALSE(setup.dispatcher.waiting());
  }
}

}  // namespace scheduling_dispatcher_test
