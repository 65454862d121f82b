#include "ocm/measure/recent.hpp"

#include <chrono>
#include <cmath>
#include <cstdint>
#include <deque>
#include <initializer_list>
#include <random>
#include <utility>

#include <catch2/catch.hpp>

namespace measure_recent_test {

using namespace std::chrono_literals;
using namespace ocm::measure;
using ocm::base::Duration;
using ocm::base::Time;

constexpr Time at(Duration since) {
  return Time{since};
}

/// As of the newest sample.
auto figures_of(std::initializer_list<int> milliseconds) {
  RecentTimes times;
  for (const int ms : milliseconds) times.add(at(std::chrono::milliseconds{ms}));
  return times.figures(at(std::chrono::milliseconds{*(milliseconds.end() - 1)}));
}
RecentTimes times_of(std::initializer_list<int> milliseconds) {
  RecentTimes times;
  for (const int ms : milliseconds) times.add(at(std::chrono::milliseconds{ms}));
  return times;
}

TEST_CASE("recent times: by hand") {
  CHECK(RecentTimes{}.figures(at(0s)).distances == 0);
  CHECK(figures_of({5}).distances == 0);
  CHECK(figures_of({5}).rate_hz == 0.0);
  // 100, 110, 90, 100 ms: squares 0 + 100 + 100 + 0, deviation sqrt(50) = 7.0711 ms.
  const auto figures = figures_of({0, 100, 210, 300, 400});
  CHECK(figures.distances == 4);
  CHECK(figures.rate_hz == Approx(10.0));
  CHECK(figures.jitter_ns == Approx(7.0710678e6));
  RecentTimes shortest;
  shortest.add(at(0ns));
  shortest.add(at(1ns));
  CHECK(shortest.figures(at(1ns)).rate_hz == Approx(1e9));
}

TEST_CASE("recent times: the jitter of a nanosecond is not lost in distances of many") {
  // 100 ms, 100 ms, and one ns more: squares 1/9 + 1/9 + 4/9, deviation sqrt(2/9) ns.
  RecentTimes times;
  for (const auto time : {0ns, 100'000'000ns, 200'000'000ns, 300'000'001ns}) times.add(at(time));
  CHECK(times.figures(at(300'000'001ns)).jitter_ns == Approx(std::sqrt(2.0 / 9)));
}

TEST_CASE("recent times: of two seconds, but always the newest distance, and of sixteen at most") {
  CHECK(figures_of({0, 1000, 2000, 3000, 4000}).distances == 2);
  CHECK(figures_of({0, 1000, 1990, 2990}).distances == 2);
  const auto slow = figures_of({0, 10'000, 40'000});
  CHECK(slow.distances == 1);
  CHECK(slow.rate_hz == Approx(1.0 / 30));
  RecentTimes many;
  for (int ms = 0; ms < 100; ++ms) many.add(at(std::chrono::milliseconds{ms}));
  CHECK(many.figures(at(99ms)).distances == 16);
  CHECK(many.figures(at(99ms)).rate_hz == Approx(1000));
  CHECK(many.figures(at(99ms)).jitter_ns == Approx(0).margin(1e-3));
}

TEST_CASE(
    "recent times: what came before a pause that was meant, or a clock that was set back, is forgotten") {
  RecentTimes times = times_of({0, 10, 20});
  times.restart();
  CHECK(times.figures(at(20ms)).distances == 0);
  times.add(at(5s));
  CHECK(times.figures(at(5s)).distances == 0);
  times.add(at(5100ms));
  CHECK(times.figures(at(5100ms)).rate_hz == Approx(10));
  times.add(at(1s));
  CHECK(times.figures(at(1s)).distances == 0);
  times.add(at(1s));  // two at the same time: no rate can be said
  CHECK(times.figures(at(1s)).distances == 1);
  CHECK(times.figures(at(1s)).rate_hz == 0.0);
}

TEST_CASE(
    "recent times: a stream that stopped has no figures after two seconds, a slow one between its samples") {
  const RecentTimes fast = times_of({0, 100, 200, 300, 400});
  CHECK(fast.figures(at(400ms)).distances == 4);
  CHECK(fast.figures(at(2'000ms)).distances == 4);
  CHECK(fast.figures(at(2'001ms)).distances == 3);
  CHECK(fast.figures(at(2'400ms)).rate_hz == Approx(10));
  CHECK(fast.figures(at(2'401ms)).distances == 0);
  CHECK(fast.figures(at(2'401ms)).rate_hz == 0.0);
  CHECK(fast.figures(at(12s)).jitter_ns == 0.0);
  // A clock that was set back: as of the newest sample.
  CHECK(fast.figures(at(-5s)).distances == 4);
  const RecentTimes slow = times_of({0, 10'000});
  CHECK(slow.figures(at(29s)).rate_hz == Approx(0.1));
  CHECK(slow.figures(at(30s)).distances == 1);
  CHECK(slow.figures(at(30'001ms)).distances == 0);
}

TEST_CASE("recent load: by hand") {
  RecentLoad load;
  CHECK(load.bits(at(10s)) == 0);
  CHECK(load.share(at(10s), at(10s), 1000) == 0.0);
  load.add(at(10s), 100);
  CHECK(load.share(at(10s), at(10s), 0) == 0.0);
  // Before the first tenth is over, of half a tenth at least.
  CHECK(load.share(at(10s), at(10s), 1000) == Approx(100 / 50.0));
  CHECK(load.share(at(10'080ms), at(10s), 1000) == Approx(100 / 80.0));
  CHECK(load.bits(at(10'099ms)) == 0);
  CHECK(load.bits(at(10'100ms)) == 100);
  CHECK(load.share(at(10'250ms), at(10s), 1000) == Approx(0.5));
  load.add(at(10'500ms), 100);
  CHECK(load.bits(at(10'900ms)) == 200);
  CHECK(load.share(at(10'999'999us), at(10s), 1000) == Approx(200 / 900.0));
  CHECK(load.share(at(11'000ms), at(10s), 1000) == Approx(0.2));
  // Had it been listened to for an hour: of a second.
  CHECK(load.share(at(10'250ms), at(-3600s), 1000) == Approx(0.1));
  // The first tenth is out of the second.
  CHECK(load.bits(at(11'100ms)) == 100);
  CHECK(load.share(at(11'400ms), at(10s), 1000) == Approx(0.1));
  CHECK(load.bits(at(11'600ms)) == 0);
}

TEST_CASE("recent load: from half a tenth that is over on, what is under way does not count") {
  RecentLoad load;
  load.add(at(10'060ms), 100);
  load.add(at(10'140ms), 300);
  CHECK(load.share(at(10'150ms), at(10'050ms), 1000) == Approx(100 / 50.0));
  CHECK(load.share(at(10'150ms), at(10'050ms + 1ns), 1000) == Approx(400 / 100.0));
}

TEST_CASE("recent load: a clock that is set back a little changes nothing, far back it drops all before it") {
  RecentLoad load;
  load.add(at(10s), 100);
  CHECK(load.bits(at(9'950ms)) == 0);
  load.add(at(9'950ms), 10);
  CHECK(load.bits(at(10'100ms)) == 110);
  load.add(at(8'950ms), 7);  // a tenth more than the second
  CHECK(load.bits(at(9s)) == 7);
  CHECK(load.bits(at(10'100ms)) == 0);
  load.add(at(5s), 7);
  CHECK(load.bits(at(5'100ms)) == 7);
  CHECK(load.bits(at(10'100ms)) == 0);
  load.add(at(-3s), 5);  // before 1970: a log whose times count from anything
  CHECK(load.bits(at(-2'900ms)) == 5);
  load.add(at(-2'950ms), 5);
  CHECK(load.bits(at(-2'900ms)) == 10);
}

TEST_CASE("recent load: as many bits as came in the ten tenths") {
  std::mt19937 random{7};
  RecentLoad load;
  std::deque<std::pair<std::int64_t, unsigned>> all;
  constexpr std::int64_t tenth = 100'000'000;
  std::int64_t now = 0;
  for (int i = 0; i < 20'000; ++i) {
    now += static_cast<std::int64_t>(random() % 3 == 0 ? random() % 400'000'000 : random() % 2'000'000);
    const auto bits = static_cast<unsigned>(random() % 200);
    load.add(Time{Duration{now}}, bits);
    all.emplace_back(now, bits);
    const std::int64_t later = now + static_cast<std::int64_t>(random() % 1'500'000'000);
    while (all.front().first / tenth < now / tenth - 10) all.pop_front();
    std::uint64_t expected = 0;
    for (const auto& [time, count] : all)
      if (time / tenth >= later / tenth - 10 && time / tenth < later / tenth) expected += count;
    REQUIRE(load.bits(Time{Duration{later}}) == expected);
  }
}

}  // namespace measure_recent_test
