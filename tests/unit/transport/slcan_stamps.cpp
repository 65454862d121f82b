#include "ocm/transport/slcan_stamps.hpp"

#include <catch2/catch.hpp>

namespace transport_slcan_stamps_test {

using namespace ocm;
using namespace std::chrono_literals;
using transport::StampClock;

TEST_CASE("slcan: time stamps across minutes, hours of silence, delays, drift and a restart") {
  const auto at = [](std::int64_t ms) { return base::Time{std::chrono::milliseconds{ms + 1'000'000}}; };
  const auto stamp = [](std::int64_t ms) {
    return static_cast<std::uint16_t>((ms % 60'000 + 60'000) % 60'000);
  };
  SECTION("every 7 s for a day, each delayed by up to 20 ms: never later than it came, never off by more") {
    StampClock clock;
    for (std::int64_t ms = 0, i = 0; ms < 86'400'000; ms += 7000, ++i) {
      const std::int64_t delay = i * 7919 % 21;
      const base::Time mapped = clock.map(stamp(ms + 12'345), at(ms + delay));
      CHECK(mapped <= at(ms + delay));
      if (i > 30) REQUIRE(std::chrono::abs(mapped - at(ms)) <= 20ms);
    }
  }
  SECTION("silence of minutes and hours") {
    StampClock clock;
    std::int64_t ms = 59'990;
    CHECK(clock.map(stamp(ms), at(ms)) == at(ms));
    for (const std::int64_t pause : {20, 59'999, 60'000, 60'001, 119'990, 600'000, 3'600'007}) {
      ms += pause;
      REQUIRE(clock.map(stamp(ms), at(ms)) == at(ms));
      REQUIRE(clock.map(stamp(ms), at(ms + 3)) <= at(ms + 3));
    }
  }
  SECTION("an adapter that is 100 ppm slow, and one that is 100 ppm fast") {
    for (const int ppm : {-100, 100}) {
      StampClock clock;
      for (std::int64_t ms = 0; ms < 3'600'000; ms += 1000)
        REQUIRE(std::chrono::abs(clock.map(stamp(ms + ms * ppm / 1'000'000), at(ms)) - at(ms)) <= 2ms);
    }
  }
  SECTION("a stamp that goes back a little") {
    StampClock clock;
    (void)clock.map(stamp(1000), at(1000));
    CHECK(std::chrono::abs(clock.map(stamp(998), at(1001)) - at(998)) < 1us);
    CHECK(clock.map(stamp(1002), at(1002)) == at(1002));
  }
  SECTION("an adapter that restarts") {
    StampClock clock;
    (void)clock.map(stamp(50'000), at(50'000));
    CHECK(clock.map(stamp(20'000), at(60'000)) == at(60'000));
    CHECK(clock.map(stamp(21'000), at(61'000)) == at(61'000));
  }
}

/// Of this machine's clock.
constexpr base::Time at(base::Duration after) {
  return base::Time{1000s} + after;
}

TEST_CASE("slcan: the first frame was sent when it came") {
  StampClock clock;
  CHECK(clock.map(59'999, at(0s)) == at(0s));
}

TEST_CASE("slcan: a frame that was delayed is as far from the one before as the adapter says") {
  StampClock clock;
  CHECK(clock.map(1000, at(0ms)) == at(0ms));
  CHECK(clock.map(1010, at(15ms)) == at(10ms + 3us));  // 200 ppm of 15 ms
  CHECK(clock.map(1020, at(20ms)) == at(20ms));
}

TEST_CASE("slcan: the adapter's clock may be slower by 200 ppm, a part of the time that has passed") {
  StampClock clock;
  CHECK(clock.map(0, at(0s)) == at(0s));
  CHECK(clock.map(10'000, at(10s + 1s)) == at(10s + 2'200us));
  CHECK(clock.map(20'000, at(20s + 1s)) == at(20s + 4'200us));
}

TEST_CASE("slcan: a frame that comes sooner than any before shows that those were delayed") {
  StampClock clock;
  CHECK(clock.map(0, at(5ms)) == at(5ms));
  CHECK(clock.map(100, at(102ms)) == at(102ms));
  CHECK(clock.map(200, at(205ms)) == at(202ms + 20us + 600ns));
}

TEST_CASE("slcan: minutes of silence are those of this machine's clock, to half a minute") {
  StampClock clock;
  CHECK(clock.map(0, at(0s)) == at(0s));
  CHECK(clock.map(1000, at(121s)) == at(121s));
  CHECK(clock.map(1500, at(121s + 500ms)) == at(121s + 500ms));
}

TEST_CASE("slcan: a delay of five seconds is one, and a longer one is an adapter that has restarted") {
  StampClock late;
  CHECK(late.map(0, at(0s)) == at(0s));
  CHECK(late.map(1000, at(6s)) == at(1s + 1200us));
  StampClock restarted;
  CHECK(restarted.map(0, at(0s)) == at(0s));
  CHECK(restarted.map(1000, at(6s + 2ms)) == at(6s + 2ms));
  CHECK(restarted.map(1500, at(6s + 502ms)) == at(6s + 502ms));
}

TEST_CASE("slcan: a minute of silence is one also where the frame behind it was delayed") {
  StampClock clock;
  CHECK(clock.map(0, at(0s)) == at(0s));
  CHECK(clock.map(0, at(61s)) == at(60s + 12'200us));
}

TEST_CASE("slcan: an arrival before the one before is one at the same time") {
  StampClock clock;
  CHECK(clock.map(0, at(1s)) == at(1s));
  CHECK(clock.map(10, at(0s)) == at(0s));
}

TEST_CASE(
    "slcan: a stamp that is half a minute ahead of the arrivals is ahead, and one beyond that is behind") {
  StampClock ahead;
  CHECK(ahead.map(0, at(40s)) == at(40s));
  CHECK(ahead.map(30'000, at(12s)) == at(12s));
  StampClock behind;
  CHECK(behind.map(0, at(40s)) == at(40s));
  CHECK(behind.map(30'001, at(12s)) == at(10s + 1ms));
}

}  // namespace transport_slcan_stamps_test
