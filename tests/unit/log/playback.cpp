#include "ocm/log/playback.hpp"

#include <random>

#include <catch2/catch.hpp>

namespace log_playback_test {

using namespace ocm;
using namespace std::chrono_literals;
using log::Playback;
using log::PlaybackOptions;

constexpr base::Time at(base::Duration since) {
  return base::Time{since};
}

TEST_CASE("frames are played at their distances from the first") {
  Playback playback;
  playback.begin(at(100s), at(7000s));
  CHECK(playback.due(at(7000s)) == at(100s));
  CHECK(playback.due(at(7000s + 1ns)) == at(100s + 1ns));
  CHECK(playback.due(at(7003s)) == at(103s));
  CHECK(playback.last_due() == at(103s));
  CHECK(playback.backward() == 0);
}

TEST_CASE("at its own speed a log is exact to the nanosecond however long it is") {
  Playback playback;
  playback.begin(at(0s), at(0s));
  const base::Duration beyond_a_double{(std::int64_t{1} << 53) + 1};  // 104 days
  CHECK(playback.due(at(beyond_a_double)) == at(beyond_a_double));
}

TEST_CASE("an hour of playback ends to the nanosecond where it should") {
  // 900 us, the shortest period of the thesis, and a player that is always a little late.
  for (const double speed : {1.0, 3.0, 0.7}) {
    Playback playback{{.speed = speed}};
    base::Time now = at(5s);
    playback.begin(now, at(0s));
    std::mt19937 random{1};
    base::Time due{};
    for (std::int64_t i = 0; i <= 4'000'000; ++i) {
      due = playback.due(at(i * 900us));
      now = std::max(now, due) + base::Duration{random() % 2'000'000};
      playback.sent(due, now);
    }
    const auto hour = static_cast<std::int64_t>(std::llround(3.6e12 / speed));
    CHECK(due == at(5s + base::Duration{hour}));
  }
}

TEST_CASE("speed divides distances, and no pause changes order") {
  Playback playback{{.speed = 4}};
  playback.begin(at(0s), at(10s));
  CHECK(playback.due(at(14s)) == at(1s));
  CHECK(playback.due(at(14s + 2ns)) == at(1s + 1ns));  // half a nanosecond is rounded up
  Playback slow{{.speed = 0.5}};
  slow.begin(at(0s), at(10s));
  CHECK(slow.due(at(11s)) == at(2s));
}

TEST_CASE("a frame a little out of order is due at once and shifts nothing") {
  Playback playback;
  playback.begin(at(0s), at(10s));
  CHECK(playback.due(at(11s)) == at(1s));
  CHECK(playback.due(at(11s - 999ms)) == at(1s));
  CHECK(playback.due(at(12s)) == at(2s));
  CHECK(playback.backward() == 1);
}

TEST_CASE("a clock that was set back does not hold the log up") {
  Playback playback;
  playback.begin(at(0s), at(10'000s));
  CHECK(playback.due(at(10'001s)) == at(1s));
  CHECK(playback.due(at(6'000s)) == at(1s));
  CHECK(playback.due(at(6'002s)) == at(3s));
  CHECK(playback.backward() == 1);
  SECTION("exactly the limit counts as set") {
    CHECK(playback.due(at(6'001s)) == at(3s));
    CHECK(playback.due(at(6'002s)) == at(4s));
  }
}

TEST_CASE("a pause over the longest is cut") {
  Playback playback{{.longest_gap = 2s}};
  playback.begin(at(0s), at(0s));
  CHECK(playback.due(at(2s)) == at(2s));
  CHECK(playback.due(at(3602s)) == at(4s));
  CHECK(playback.due(at(3603s)) == at(5s));
  CHECK(playback.cut() == 1);
}

TEST_CASE("a second pass begins where the first one ended") {
  Playback playback;
  playback.begin(at(50s), at(10s));
  static_cast<void>(playback.due(at(13s)));
  playback.begin(playback.last_due(), at(10s));
  CHECK(playback.due(at(10s)) == at(53s));
  CHECK(playback.due(at(11s)) == at(54s));
}

TEST_CASE("frames that go out late are counted") {
  Playback playback;
  CHECK(playback.worst() == base::Duration{});
  playback.sent(at(1s), at(500ms));  // early: a clock that is not exact
  CHECK(playback.worst() == base::Duration{});
  playback.sent(at(1s), at(1s));
  playback.sent(at(1s), at(1s + 999'999ns));
  CHECK(playback.late() == 0);
  playback.sent(at(1s), at(1s + 1ms));
  CHECK(playback.late() == 1);
  CHECK(playback.worst() == base::Duration{1ms});
}

TEST_CASE("times from one end of the clock to the other are played without overflow") {
  Playback playback;
  playback.begin(at(1s), base::Time::min());
  CHECK(playback.due(base::Time::max()) == base::never);
  CHECK(playback.due(base::Time::min()) == base::never);
  CHECK(Playback::distance(base::Time::max(), base::Time::min()) == base::Duration::max());
  CHECK(Playback::distance(base::Time::min(), base::Time::max()) == -base::Duration::max());
  CHECK(Playback::later(base::Time::max() - 1s, 2s) == base::Time::max());
  CHECK(Playback::later(base::Time::min() + 1s, -2s) == base::Time::min());
  CHECK(Playback::later(at(1s), -3s) == at(-2s));
  Playback slow{{.speed = 1e-6}};
  slow.begin(at(0s), at(0s));
  CHECK(slow.due(at(100h * 24 * 365)) == base::never);
  // 2^62 ns at half the speed take 2^63, one more than fits.
  Playback half{{.speed = 0.5}};
  half.begin(base::Time::min(), at(0s));
  CHECK(half.due(base::Time{base::Duration{std::int64_t{1} << 62}}) == at(-1ns));
}

}  // namespace log_playback_test
