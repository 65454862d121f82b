#include "ocm/reflective/adaptation.hpp"

#include <chrono>
#include <random>

#include <catch2/catch.hpp>

namespace reflective_adaptation_test {

using namespace ocm;
using namespace ocm::reflective;
using namespace std::chrono_literals;

constexpr Adaptation ring{
    .magnitude = true, .from = 10, .to = 110, .at_from = 200ms, .at_to = 50ms, .grain = 10ms};
static_assert(adapted_period(ring, 0) == 200ms && adapted_period(ring, 10) == 200ms);
static_assert(adapted_period(ring, 110) == 50ms && adapted_period(ring, INT64_MAX) == 50ms);
static_assert(adapted_period(ring, -110) == 50ms && adapted_period(ring, INT64_MIN) == 50ms);
static_assert(adapted_period(ring, 60) == 120ms);  // 125, towards the shorter
constexpr Adaptation slower{.from = -50, .to = 50, .at_from = 10ms, .at_to = 20ms, .grain = 1ms};
static_assert(adapted_period(slower, -50) == 10ms && adapted_period(slower, 0) == 15ms);
static_assert(adapted_period(slower, 50) == 20ms);
// To the nanosecond: 1.5 of them for each step of the value.
constexpr Adaptation fine{.from = 0, .to = 100, .at_from = 1'000ns, .at_to = 1'150ns, .grain = 1ns};
static_assert(adapted_period(fine, 50) == 1'075ns && adapted_period(fine, 99) == 1'148ns);
// In whole milliseconds if it says nothing else.
static_assert(adapted_period({.from = 0, .to = 100, .at_from = 10ms, .at_to = 20ms}, 59) == 15ms);
// Over as many values as it tells apart, from the first to the last but one.
constexpr Adaptation wide{.from = 0, .to = 2'097'151, .at_from = 1s, .at_to = 1s + 2'097'151us, .grain = 1ns};
static_assert(adapted_period(wide, 5) == 1s + 5us && adapted_period(wide, 2'097'150) == 1s + 2'097'150us);
static_assert(adapted_period(wide, 1'048'577) == 1s + 1'048'577us);
constexpr Adaptation wider{.from = 0, .to = 1 << 30, .at_from = 1s, .at_to = 2s, .grain = 1ns};
static_assert(adapted_period(wider, 1 << 29) == 1500ms);  // in parts of 1024
// In parts of 3, of which there are 1'398'101: the one millionth of them is a second further.
constexpr Adaptation thirds{
    .from = 0, .to = 4'194'303, .at_from = 1s, .at_to = 1s + 1'398'101us, .grain = 1ns};
static_assert(adapted_period(thirds, 3'000'000) == 2s);
// A grain that is none is the smallest one.
static_assert(adapted_period({.to = 100, .at_from = 10ns, .at_to = 20ns, .grain = 0ns}, 50) == 15ns);

TEST_CASE("adaptation: within its bounds, in grains, and never back, for any numbers") {
  std::mt19937_64 random{5};
  for (int run = 0; run < 20'000; ++run) {
    Adaptation a;
    a.magnitude = random() % 2 == 0;
    const int shift = static_cast<int>(random() % 63);
    a.from = static_cast<std::int64_t>(random()) >> shift;
    a.to = static_cast<std::int64_t>(random()) >> shift;
    if (a.from == a.to) continue;
    if (a.from > a.to) std::swap(a.from, a.to);
    a.grain = base::Duration{1'000 * (1 + static_cast<std::int64_t>(random() % 5'000))};
    const base::Duration shortest{1'000 * (1 + static_cast<std::int64_t>(random() % 1'000'000))};
    a.at_from = shortest + static_cast<std::int64_t>(random() % 1000) * a.grain;
    a.at_to = shortest;
    if (random() % 2 == 0) std::swap(a.at_from, a.at_to);
    const bool shorter = a.at_to < a.at_from;
    base::Duration last = a.at_from;
    for (int i = 0; i <= 20; ++i) {
      // Without sign: the whole range does not fit in one with sign.
      const auto from = static_cast<std::uint64_t>(a.from);
      const auto step = (static_cast<std::uint64_t>(a.to) - from) / 20;
      auto value = static_cast<std::int64_t>(from + step * static_cast<unsigned>(i));
      if (a.magnitude && value < 0) value = 0;
      const base::Duration period = adapted_period(a, value);
      if (period < a.shortest() || period > a.longest()) FAIL("out of bounds in run " << run);
      if ((period - a.shortest()) % a.grain != 0ns) FAIL("between grains in run " << run);
      if (!a.magnitude && (shorter ? period > last : period < last)) FAIL("back in run " << run);
      last = period;
    }
  }
}

}  // namespace reflective_adaptation_test
