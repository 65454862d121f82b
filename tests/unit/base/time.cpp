#include "ocm/base/time.hpp"

#include <type_traits>

#include <catch2/catch.hpp>

namespace base_time_test {

using namespace std::chrono_literals;
using ocm::base::Duration;
using ocm::base::Time;

TEST_CASE("time counts whole nanoseconds, and every bit time is a whole number of them") {
  STATIC_REQUIRE(Duration{1s}.count() == 1'000'000'000);
  STATIC_REQUIRE(Duration{1s} / 500'000 == 2us);
  STATIC_REQUIRE(Duration{1s} % 500'000 == 0ns);
  STATIC_REQUIRE(Duration{1s} % 1'000'000 == 0ns);
  STATIC_REQUIRE((Time{3us} - Time{1us}) == 2us);
  STATIC_REQUIRE((Time{1us} - Time{3us}) == -2us);
}

TEST_CASE("never is later than any time that comes") {
  STATIC_REQUIRE(ocm::base::never > Time{std::chrono::hours{24 * 365 * 292}});
}

template <class Clock>
concept TellsTheTime = requires {
  Clock::now();
};

TEST_CASE("the caller's clock cannot be read, nor mixed with a host's") {
  STATIC_REQUIRE(TellsTheTime<std::chrono::steady_clock>);
  STATIC_REQUIRE_FALSE(TellsTheTime<ocm::base::Clock>);
  STATIC_REQUIRE_FALSE(std::is_convertible_v<std::chrono::steady_clock::time_point, Time>);
  STATIC_REQUIRE_FALSE(std::is_convertible_v<std::int64_t, Duration>);
}

}  // namespace base_time_test
