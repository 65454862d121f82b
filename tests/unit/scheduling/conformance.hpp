/// What every port must do, as a test that runs on any of them: with virtual time, on threads, on an RTOS's
/// host simulator. A `Setup` brings the port up:
///
///     struct Setup {
///       using Port = ...;
///       Port& port();
///       void attach(std::function<void()> expire, std::function<void(Level)> run);  // before anything else
///       void let_pass(base::Duration time);   // the port's contexts run meanwhile
///       void stop();                          // no context runs after it
///       static constexpr base::Duration slack{...};  // how late the port may be; zero in virtual time
///     };
///
/// They need nothing but patience: what is to happen is waited for, as long as `slack` at most.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <functional>

#include <catch2/catch.hpp>

#include "ocm/base/time.hpp"
#include "ocm/scheduling/dispatcher.hpp"
#include "ocm/scheduling/port.hpp"

namespace conformance {

using namespace ocm;
using namespace std::chrono_literals;
using scheduling::Level;

inline constexpr Level levels[] = {Level::urgent, Level::high, Level::medium, Level::low};

/// What came, counted; any context may count.
struct Witness {
  std::atomic<int> expired{0};
  std::atomic<base::Duration::rep> expired_at{0};
  std::array<std::atomic<int>, 4> ran{};

  [[nodiscard]] int runs(Level level) const { return ran[static_cast<std::size_t>(level)]; }
};

template <class Setup>
void watch(Setup& setup, Witness& witness) {
  setup.attach(
      [&] {
        witness.expired_at = setup.port().now().time_since_epoch().count();
        ++witness.expired;
      },
      [&](Level level) { ++witness.ran[static_cast<std::size_t>(level)]; });
}
template <class Setup>
void arm(Setup& setup, base::Time when) {
  [[maybe_unused]] const auto guard = setup.port().lock();
  setup.port().arm(when);
}
template <class Setup>
void pend(Setup& setup, Level level) {
  [[maybe_unused]] const auto guard = setup.port().lock();
  setup.port().pend(level);
}

/// Lets time pass until it is so, or it is too late.
template <class Setup, class Condition>
void wait_for(Setup& setup, Condition condition) {
  for (base::Duration waited{}; !condition() && waited <= Setup::slack; waited += 2ms) setup.let_pass(2ms);
}

template <class Setup>
void the_clock_is_monotonic() {
  Setup setup;
  Witness witness;
  watch(setup, witness);
  const base::Time start = setup.port().now();
  setup.let_pass(5ms);
  const base::Time end = setup.port().now();
  setup.stop();
  CHECK(end - start >= 5ms);
}

template <class Setup>
void the_timer_goes_off_once_at_its_time() {
  Setup setup;
  Witness witness;
  watch(setup, witness);
  const base::Time when = setup.port().now() + 20ms;
  arm(setup, when);
  setup.let_pass(30ms);
  wait_for(setup, [&] { return witness.expired > 0; });
  setup.let_pass(30ms);
  setup.stop();
  REQUIRE(witness.expired == 1);
  CHECK(witness.expired_at >= when.time_since_epoch().count());
  CHECK(witness.expired_at <= (when + Setup::slack).time_since_epoch().count());
}

template <class Setup>
void arming_replaces_what_was_armed() {
  Setup setup;
  Witness witness;
  watch(setup, witness);
  const base::Time start = setup.port().now();
  arm(setup, start + 10s);
  arm(setup, start + 20ms);  // earlier
  setup.let_pass(30ms);
  wait_for(setup, [&] { return witness.expired > 0; });
  const int once = witness.expired;
  arm(setup, setup.port().now() + 10s);
  arm(setup, base::never);  // not at all
  setup.let_pass(Setup::slack == base::Duration{0} ? 20s : 50ms);
  setup.stop();
  CHECK(once == 1);
  CHECK(witness.expired == 1);
}

template <class Setup>
void a_time_that_has_passed_goes_off_at_once() {
  Setup setup;
  Witness witness;
  watch(setup, witness);
  setup.let_pass(5ms);
  arm(setup, setup.port().now() - 1ms);
  setup.let_pass(1ms);
  wait_for(setup, [&] { return witness.expired > 0; });
  setup.stop();
  CHECK(witness.expired == 1);
}

template <class Setup>
void a_pended_level_runs_and_only_that() {
  for (const Level level : levels) {
    Setup setup;
    Witness witness;
    watch(setup, witness);
    pend(setup, level);
    setup.let_pass(1ms);
    wait_for(setup, [&] { return witness.runs(level) > 0; });
    setup.let_pass(5ms);
    setup.stop();
    for (const Level other : levels) CHECK(witness.runs(other) == (other == level ? 1 : 0));
    CHECK(witness.expired == 0);
  }
}

/// A pend while the level runs is not lost: neither its own nor another context's.
template <class Setup>
void a_level_that_is_pended_while_it_runs_runs_again() {
  Setup setup;
  std::atomic<int> runs{0};
  setup.attach([] {},
               [&](Level) {
                 if (++runs < 5) pend(setup, Level::medium);
               });
  pend(setup, Level::medium);
  setup.let_pass(5ms);
  wait_for(setup, [&] { return runs >= 5; });
  setup.stop();
  CHECK(runs == 5);
}

/// Whatever the order in which levels are pended, they begin by their urgency.
template <class Setup>
void the_more_urgent_level_goes_first() {
  Setup setup;
  std::atomic<int> order{0};
  std::array<std::atomic<int>, 4> when{};
  setup.attach([] {},
               [&](Level level) {
                 when[static_cast<std::size_t>(level)] = ++order;
                 if (level != Level::high) return;
                 [[maybe_unused]] const auto guard = setup.port().lock();
                 setup.port().pend(Level::low);
                 setup.port().pend(Level::medium);
                 setup.port().pend(Level::urgent);
               });
  pend(setup, Level::high);
  setup.let_pass(5ms);
  wait_for(setup, [&] { return order >= 4; });
  setup.stop();
  CHECK(order == 4);
  CHECK(when[1] == 1);
  CHECK(when[0] == 2);
  CHECK(when[2] == 3);
  CHECK(when[3] == 4);
}

/// The whole of it: a dispatcher on the port releases on its grid.
template <class Setup>
void a_dispatcher_releases_on_its_grid() {
  Setup setup;
  scheduling::Dispatcher<2, typename Setup::Port> dispatcher{setup.port()};
  std::array<std::atomic<int>, 2> samples{};
  std::atomic<int> off_grid{0};
  const base::Time start = setup.port().now();
  setup.attach([&] { dispatcher.expire(); },
               [&](Level level) {
                 dispatcher.run(level, [&](const scheduling::Release& release) {
                   ++samples[release.stream];
                   const base::Duration period = release.stream == 0 ? 10ms : 25ms;
                   if ((release.scheduled - start) % period != 0ns) ++off_grid;
                   return scheduling::Outcome::done;
                 });
               });
  dispatcher.start(0, 10ms, Level::urgent, start);
  dispatcher.start(1, 25ms, Level::low, start);
  setup.let_pass(205ms);
  if (Setup::slack !=
      base::Duration{0}) {  // a job counts what it missed when it runs, which a busy host puts off
    const std::array<int, 2> before{samples[0], samples[1]};
    for (int i = 0; i < 300 && (samples[0] == before[0] || samples[1] == before[1]); ++i)
      setup.let_pass(20ms);
  }
  dispatcher.stop(0);
  dispatcher.stop(1);
  setup.let_pass(50ms);
  setup.stop();
  CHECK(off_grid == 0);
  const auto missed = [&](std::size_t stream) {
    return static_cast<int>(dispatcher.overload(stream).missed);
  };
  if (Setup::slack == base::Duration{0}) {
    CHECK(samples[0] == 21);
    CHECK(samples[1] == 9);
    CHECK(missed(0) + missed(1) == 0);
  } else {  // the host may have been busy: nothing is lost without being counted
    CHECK(samples[0] + missed(0) >= 20);
    CHECK(samples[1] + missed(1) >= 8);
  }
}

template <class Setup>
void check() {
  the_clock_is_monotonic<Setup>();
  the_timer_goes_off_once_at_its_time<Setup>();
  arming_replaces_what_was_armed<Setup>();
  a_time_that_has_passed_goes_off_at_once<Setup>();
  a_pended_level_runs_and_only_that<Setup>();
  a_level_that_is_pended_while_it_runs_runs_again<Setup>();
  the_more_urgent_level_goes_first<Setup>();
  a_dispatcher_releases_on_its_grid<Setup>();
}

}  // namespace conformance
