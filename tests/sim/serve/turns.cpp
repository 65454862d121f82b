// Parts of the simulators' loops by themselves: who commands in turns with whom, simulated time,
// interference.
#include "sim/serve/turns.hpp"

#include <chrono>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/simulation/arbiter.hpp"
#include "ocm/topics/amiro.hpp"

#include "sim/serve/clock.hpp"
#include "sim/serve/interference.hpp"
#include "sim/serve/round.hpp"

namespace sim_serve_turns_test {

using namespace ocm;
using namespace std::chrono_literals;
using simulation::Delivery;
using simulation::NodeId;

constexpr NodeId one{1, 1}, two{2, 1}, three{3, 1};

/// A set point of the motors, the timeout of which is half a second.
Delivery motors(NodeId from, base::Duration at, std::uint8_t speed = 1) {
  Delivery delivery;
  delivery.frame = {0x200U + amiro::Motors::id.value, 8, {speed}};
  delivery.from = from;
  delivery.time = base::Time{at};
  return delivery;
}
std::uint64_t turns_of(const std::vector<Delivery>& frames) {
  sim::Turns turns{amiro::catalogue};
  for (const Delivery& frame : frames) turns.take(frame);
  std::uint64_t found = 0;
  turns.each([&found](const protocol::Topic& topic, std::uint64_t count) {
    CHECK(topic.name == "motors");
    found += count;
  });
  return found;
}

TEST_CASE("turns: two senders that command one actuator, each within the other's timeout") {
  static_assert(amiro::Motors::timeout == 500ms);
  CHECK(turns_of({}) == 0);
  CHECK(turns_of({motors(one, 0ms), motors(one, 100ms), motors(one, 200ms)}) == 0);
  CHECK(turns_of({motors(one, 0ms), motors(two, 100ms)}) == 0);  // one took over from the other
  CHECK(turns_of({motors(one, 0ms), motors(two, 100ms), motors(two, 200ms)}) == 0);
  CHECK(turns_of({motors(one, 0ms), motors(two, 100ms), motors(one, 200ms)}) == 1);
  CHECK(turns_of({motors(one, 0ms), motors(two, 100ms), motors(one, 200ms), motors(two, 300ms)}) == 2);
  // Within the timeout of what it sent itself, and no longer.
  CHECK(turns_of({motors(one, 0ms), motors(two, 100ms), motors(one, 499ms)}) == 1);
  CHECK(turns_of({motors(one, 0ms), motors(two, 100ms), motors(one, 500ms)}) == 0);
  CHECK(turns_of({motors(one, 0ms), motors(one, 400ms), motors(two, 450ms), motors(one, 899ms)}) == 1);
  CHECK(turns_of({motors(one, 0ms), motors(one, 400ms), motors(two, 450ms), motors(one, 900ms)}) == 0);
  // A stop ends a drive, which says zero then; a drive that goes on after a stop is another matter.
  CHECK(turns_of({motors(one, 0ms), motors(two, 100ms, 0), motors(one, 200ms, 0)}) == 0);
  CHECK(turns_of({motors(one, 0ms), motors(two, 100ms, 0), motors(one, 200ms)}) == 1);
  // Of three each is the last one's last one no more.
  CHECK(turns_of({motors(one, 0ms), motors(two, 10ms), motors(three, 20ms), motors(one, 30ms)}) == 0);
}

TEST_CASE("turns: of set points with a timeout alone, each actuator by itself") {
  const auto with = [](std::uint32_t id, can::Format format = can::Format::base) {
    std::vector<Delivery> frames;
    for (const auto& [from, at] : {std::pair{one, 0ms}, std::pair{two, 10ms}, std::pair{one, 20ms}}) {
      frames.push_back(motors(from, at));
      frames.back().frame.id = id;
      frames.back().frame.format = format;
    }
    return turns_of(frames);
  };
  CHECK(with(0x200 + amiro::Motors::id.value) == 1);
  CHECK(with(0x000 + amiro::Motors::id.value) == 1);                            // at another priority
  CHECK(with(0x600 + amiro::Motors::id.value) == 0);                            // a sample
  CHECK(with(0x200 + amiro::Motors::id.value, can::Format::extended) == 0);     // another identifier
  CHECK(with(0x200 + amiro::Motors::id.value, can::Format::base_remote) == 0);  // without data
  CHECK(with(0x200 + amiro::Led::id.value) == 0);                               // which has none
  CHECK(with(0x200 + amiro::Magnetometer::id.value) == 0);                      // a request
  CHECK(with(0x2FF) == 0);
  auto led = motors(two, 10ms);
  led.frame.id = 0x200 + amiro::Led::id.value;
  CHECK(turns_of({motors(one, 0ms), led, motors(one, 20ms)}) == 0);
}

TEST_CASE("simulated time goes as fast as it is asked to, and a wait for it is short") {
  const sim::SimulatedClock fast{1000}, slow{0.001};
  const auto begin = std::chrono::steady_clock::now();
  const base::Time first = fast.now();
  const base::Time slow_first = slow.now();
  while (std::chrono::steady_clock::now() - begin < 5ms) {
  }
  const base::Time later = fast.now();
  const auto real = std::chrono::steady_clock::now() - begin;
  CHECK(later - first >= 4s);
  CHECK(later - first <= 1000 * real + 1s);
  CHECK(slow.now() - slow_first <= real);
  CHECK(fast.until(fast.now()) == 0ns);
  CHECK(fast.until(first) == 0ns);
  CHECK(fast.until(fast.now() + 100s) <= 100ms);  // a thousandth
  CHECK(fast.until(fast.now() + 2000s) == 200ms);
  CHECK(fast.until(fast.now() + 2h) == 200ms);
  CHECK(fast.until(base::never) == 200ms);
  CHECK(slow.until(slow.now() + 1s) == 200ms);
  CHECK(fast.behind(fast.now() + 1h) < 0ns);
  const base::Duration behind = fast.behind(fast.now() - 10s);
  CHECK(behind >= 10ms);
  CHECK(behind < 5s);
}

TEST_CASE("a simulation is late when it is behind by a second, ten times in a row, and says so once") {
  const sim::SimulatedClock clock{1};
  std::vector<std::string> said;
  sim::Lateness lateness{[&said](std::string_view text) { said.emplace_back(text); }};
  const auto note = [&](base::Duration behind, unsigned times) {
    for (unsigned i = 0; i < times; ++i) lateness.note(sim::Round{clock.now() - behind}, clock);
  };
  lateness.sum_up();
  note(100ms, 50);
  note(2s, 9);
  note(100ms, 1);  // it has caught up
  note(2s, 9);
  CHECK(said.empty());
  lateness.sum_up();  // late, and not for long enough
  CHECK(said.empty());
  note(2s, 1);
  REQUIRE(said.size() == 1);
  CHECK(said[0].starts_with("the simulation is late: "));
  note(1h, 50);
  CHECK(said.size() == 1);
  lateness.sum_up();
  REQUIRE(said.size() == 2);
  CHECK(said[1].starts_with("late              by 3600."));
  note(100ms, 1);
  lateness.sum_up();  // in the end it is not
  CHECK(said.size() == 2);
}

TEST_CASE("interference comes at random, as often as it is asked for, and none where it is not") {
  const auto errors_in_a_minute = [](double rate, std::uint64_t seed) {
    simulation::Arbiter bus{500'000};
    sim::Interference interference{rate, seed};
    for (int second = 0; second <= 60; ++second) {
      const base::Time now{std::chrono::seconds{second}};
      interference.disturb(bus, now);
      bus.advance(now, [](const Delivery&) {});
    }
    return bus.totals().errors;
  };
  // It is a second ahead of the bus: what comes within that is disturbed.
  simulation::Arbiter bus{500'000};
  sim::Interference ahead{100, 1};
  ahead.disturb(bus, base::Time{});
  bus.advance(base::Time{1s}, [](const Delivery&) {});
  CHECK(static_cast<double>(bus.totals().errors) == Approx(100).margin(50));
  CHECK(errors_in_a_minute(0, 1) == 0);
  CHECK(errors_in_a_minute(-1, 1) == 0);
  double sum = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) sum += static_cast<double>(errors_in_a_minute(10, seed));
  CHECK(sum / 10 == Approx(600).margin(5 * std::sqrt(600.0 / 10)));
  CHECK(errors_in_a_minute(10, 1) == errors_in_a_minute(10, 1));
  CHECK(errors_in_a_minute(10, 1) != errors_in_a_minute(10, 2));
  // At the most it is one each nanosecond, in which this bus has a bit: a microsecond is over at some time.
  simulation::Arbiter quick{1'000'000'000};
  sim::Interference dense{1e12, 1};
  dense.disturb(quick, base::Time{1us - 1s});
  quick.advance(base::Time{1ms}, [](const Delivery&) {});
  CHECK(quick.totals().errors == 1000);
}

}  // namespace sim_serve_turns_test
