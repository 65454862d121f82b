// When frames came, whatever the clock does that stamps them.
#include "cli/record/frame_clock.hpp"

#include <chrono>
#include <vector>

#include <catch2/catch.hpp>

namespace frame_clock_test {

using namespace std::chrono_literals;
using namespace ocm;
using cli::record::FrameClock;

constexpr base::Duration year = std::chrono::hours{24 * 365};

log::Entry entry(base::Duration time, std::uint16_t interface = 0) {
  return {base::Time{time}, can::Frame{0x123, 0, {}}, interface};
}
/// When those of a batch came that is fetched at `now`.
std::vector<base::Duration> came(FrameClock& clock, base::Duration now, std::vector<log::Entry> entries) {
  clock.fetched(entries, now);
  std::vector<base::Duration> times;
  for (const log::Entry& each : entries) times.push_back(clock.at(each));
  return times;
}
using Times = std::vector<base::Duration>;

TEST_CASE(
    "frame clock: the newest of the first batch came just now, and the others as long before as they say") {
  FrameClock clock;
  CHECK(came(clock, 10s, {entry(year), entry(year + 1ms), entry(year + 5ms)}) ==
        Times{10s - 5ms, 10s - 4ms, 10s});
  // From then on by their own times, as far as these run with the monotonic clock.
  CHECK(came(clock, 11s, {entry(year + 900ms)}) == Times{11s - 105ms});
  CHECK(came(clock, 12s, {entry(year + 5ms + 2s + 200ms)}) == Times{12s + 200ms});
}

TEST_CASE("frame clock: times that were set count from the moment at which they came") {
  FrameClock clock;
  CHECK(came(clock, 10s, {entry(1s)}) == Times{10s});
  CHECK(came(clock, 11s, {entry(year)}) == Times{11s});
  CHECK(came(clock, 12s, {entry(year + 1s + 30ms)}) == Times{12s + 30ms});
  CHECK(came(clock, 13s, {entry(2s)}) == Times{13s});  // and set back
  CHECK(came(clock, 14s, {entry(3s - 201ms)}) == Times{14s});
  CHECK(came(clock, 15s, {entry(4s - 201ms - 200ms)}) == Times{15s - 200ms});
}

TEST_CASE("frame clock: none came before the one before it, and none in the future") {
  FrameClock clock;
  CHECK(came(clock, 10s, {entry(year)}) == Times{10s});
  CHECK(came(clock, 10s, {entry(year - 50ms)}) == Times{10s});
  // Some of before the clock was set, and some of behind it.
  CHECK(came(clock, 11s, {entry(2 * year), entry(year + 1s)}) == Times{11s + 200ms, 11s + 200ms});
}

TEST_CASE("frame clock: each interface has a clock of its own") {
  FrameClock clock;
  CHECK(came(clock, 10s, {entry(year, 0), entry(5s, 2), entry(year + 10ms, 0)}) ==
        Times{10s - 10ms, 10s, 10s});
  CHECK(came(clock, 11s, {entry(6s, 2)}) == Times{11s});
  CHECK(came(clock, 12s, {entry(year + 2s + 10ms, 0)}) == Times{12s});
}

}  // namespace frame_clock_test
