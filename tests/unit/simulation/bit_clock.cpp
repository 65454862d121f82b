#include "ocm/simulation/bit_clock.hpp"

#include <catch2/catch.hpp>

namespace simulation_bit_clock_test {

using namespace ocm;
using simulation::BitClock;
using namespace std::chrono_literals;

constexpr base::Time at(base::Duration time) {
  return base::Time{time};
}

constexpr BitClock robot{500'000};
static_assert(robot.time_of(0) == at(0ns));
static_assert(robot.time_of(1) == at(2us));
static_assert(robot.boundary_from(at(0ns)) == 0);
static_assert(robot.boundary_from(at(1ns)) == 1);
static_assert(robot.boundary_from(at(2us)) == 1);
static_assert(robot.boundary_from(at(2001ns)) == 2);

// 1.5 us a bit: nearly every boundary falls between two nanoseconds, and is rounded down.
constexpr BitClock odd{666'667};
static_assert(odd.time_of(1) == at(1499ns));  // 1499.99925
static_assert(odd.time_of(2) == at(2999ns));  // 2999.9985
static_assert(odd.boundary_from(at(1499ns)) == 1);
static_assert(odd.boundary_from(at(1500ns)) == 2);
static_assert(odd.time_of(666'667) == at(1s));
// No drift: a hundred years later, to the nanosecond.
static_assert(odd.time_of(666'667ULL * 3'155'760'000ULL) == at(876'600h));
static_assert(odd.boundary_from(at(876'600h)) == 666'667ULL * 3'155'760'000ULL);
static_assert(odd.boundary_from(at(876'600h + 1ns)) == 666'667ULL * 3'155'760'000ULL + 1);

constexpr BitClock fastest{BitClock::max_bit_rate};
static_assert(fastest.time_of(12'345) == at(12'345ns));
static_assert(fastest.boundary_from(base::never) == INT64_MAX);
static_assert(fastest.time_of(INT64_MAX) == base::never);
static_assert(fastest.time_of(UINT64_MAX) == base::never);

constexpr BitClock slowest{1};
static_assert(slowest.time_of(3) == at(3s));
static_assert(slowest.time_of(UINT64_MAX) == base::never);

// The whole range of times, from one end to the other.
constexpr BitClock early{1'000'000, base::Time::min()};
static_assert(early.boundary_from(base::Time::max()) == 18'446'744'073'709'552);
static_assert(early.time_of(18'446'744'073'709'551) == at(9'223'372'036'854'775'192ns));
static_assert(early.time_of(18'446'744'073'709'552) == base::never);
static_assert(robot.boundary_from(at(-1ns)) == 0);

TEST_CASE("a boundary's time stamp leads back to the boundary at every bit rate") {
  for (const std::uint32_t bit_rate : {1U, 3U, 83'333U, 500'000U, 666'667U, 999'999'999U, 1'000'000'000U}) {
    const BitClock clock{bit_rate, at(-17ns)};
    std::uint64_t boundary = 1;
    for (int i = 0; i < 60 && clock.time_of(boundary) != base::never; ++i) {
      CHECK(clock.boundary_from(clock.time_of(boundary)) == boundary);
      CHECK(clock.boundary_from(clock.time_of(boundary) + 1ns) == boundary + 1);
      boundary += boundary / 2 + 1;
    }
  }
}

}  // namespace simulation_bit_clock_test
