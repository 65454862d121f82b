#include "ocm/host/system_time.hpp"

#include <limits>

#include <catch2/catch.hpp>

namespace host_system_time_test {

using namespace std::chrono_literals;
using ocm::base::Duration;
using ocm::host::to_timespec;
using ocm::host::to_timeval;

constexpr bool is(timespec time, std::int64_t seconds, std::int64_t nanoseconds) {
  return time.tv_sec == seconds && time.tv_nsec == nanoseconds;
}
constexpr bool is(timeval time, std::int64_t seconds, std::int64_t microseconds) {
  return time.tv_sec == seconds && time.tv_usec == microseconds;
}

TEST_CASE("a duration is seconds and the rest") {
  STATIC_REQUIRE(is(to_timespec(0ns), 0, 0));
  STATIC_REQUIRE(is(to_timespec(1'999'999'999ns), 1, 999'999'999));
  STATIC_REQUIRE(is(to_timespec(2s), 2, 0));
  STATIC_REQUIRE(is(to_timespec(-1ns), 0, 0));
  STATIC_REQUIRE(is(to_timespec(-5s), 0, 0));
}

TEST_CASE("a limit of a socket is rounded up and never zero") {
  STATIC_REQUIRE(is(to_timeval(0ns), 0, 1));
  STATIC_REQUIRE(is(to_timeval(-5s), 0, 1));
  STATIC_REQUIRE(is(to_timeval(1ns), 0, 1));
  STATIC_REQUIRE(is(to_timeval(1us), 0, 1));
  STATIC_REQUIRE(is(to_timeval(1001ns), 0, 2));
  STATIC_REQUIRE(is(to_timeval(999'999'001ns), 1, 0));
  STATIC_REQUIRE(is(to_timeval(1'500ms), 1, 500'000));
}

TEST_CASE("the longest times stay long, also where seconds have 32 bits") {
  for (const Duration time : {Duration::max(), Duration::max() - 1ns, Duration{24h * 365 * 100}}) {
    const std::int64_t seconds = std::chrono::duration_cast<std::chrono::seconds>(time).count();
    const std::int64_t longest = std::min<std::int64_t>(seconds, std::numeric_limits<time_t>::max());
    CHECK(to_timespec(time).tv_sec == longest);
    CHECK(to_timeval(time).tv_sec == longest);
  }
  STATIC_REQUIRE(to_timeval(Duration::max() - 2us).tv_usec == 854'774);  // ...6.854'773'807, rounded up
  STATIC_REQUIRE(to_timeval(Duration::max() - 1us).tv_usec == 854'775);  // the last that is
  STATIC_REQUIRE(to_timeval(Duration::max() - 999ns).tv_usec == 854'774);
}

}  // namespace host_system_time_test
