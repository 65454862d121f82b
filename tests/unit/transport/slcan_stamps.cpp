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

}  // namespace transport_slcan_stamps_test
