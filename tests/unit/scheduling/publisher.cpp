#include "ocm/scheduling/publisher.hpp"

#include <random>

#include <catch2/catch.hpp>

namespace scheduling_publisher_test {

using namespace ocm;
using namespace std::chrono_literals;
using scheduling::Level;
using scheduling::Publisher;
using scheduling::Release;

constexpr base::Time at(base::Duration offset) {
  return base::Time{offset};
}

/// All releases that are due at `now`, most urgent first, each of them finished at once.
template <std::size_t N>
constexpr int drain(Publisher<N>& publisher, base::Time now, Release* releases) {
  int count = 0;
  for (const auto level : {Level::urgent, Level::high, Level::medium, Level::low})
    while (publisher.take_due(now, level, releases[count])) publisher.done(releases[count++].stream, now);
  return count;
}
template <std::size_t N>
constexpr bool take(Publisher<N>& publisher, base::Time now, Release& release) {
  if (!publisher.take_due(now, Level::medium, release)) return false;
  publisher.done(release.stream, now);
  return true;
}

// The first sample goes out at once; the grid starts at the reception of the request.
constexpr bool releases_on_a_grid() {
  Publisher<1> publisher;
  publisher.start(0, 500ms, Level::medium, at(100ms));
  Release release;
  if (!take(publisher, at(100ms), release) || release.scheduled != at(100ms)) return false;
  if (take(publisher, at(599ms), release)) return false;
  // 30 ms late: the thesis's publisher, which slept after its work, would go on at 1130 ms. [Thesis 7.1]
  if (!take(publisher, at(630ms), release) || release.scheduled != at(600ms)) return false;
  return publisher.next_release() == at(1100ms);
}
static_assert(releases_on_a_grid());

constexpr bool skips_whole_periods() {
  Publisher<1> publisher;
  publisher.start(0, 100ms, Level::medium, at(0ms));
  Release releases[4];
  if (drain(publisher, at(0ms), releases) != 1) return false;
  // 350 ms later the releases at 100 and 200 are gone, the one at 300 is served now, and only once.
  if (drain(publisher, at(350ms), releases) != 1) return false;
  return releases[0].missed == 2 && releases[0].late && releases[0].scheduled == at(300ms) &&
         publisher.next_release() == at(400ms);
}
static_assert(skips_whole_periods());

constexpr bool urgent_goes_first() {
  Publisher<4> publisher;
  publisher.start(0, 1s, Level::low, at(0ms));
  publisher.start(1, 1s, Level::urgent, at(0ms));
  publisher.start(2, 1s, Level::medium, at(0ms));
  publisher.start(3, 1s, Level::urgent, at(0ms));
  Release releases[5];
  if (drain(publisher, at(0ms), releases) != 4) return false;
  return releases[0].stream == 1 && releases[1].stream == 3 && releases[2].stream == 2 &&
         releases[3].stream == 0;
}
static_assert(urgent_goes_first());

constexpr bool once_stops_a_publisher() {  // thesis figure 5.2
  Publisher<1> publisher;
  publisher.start(0, 100ms, Level::medium, at(0ms));
  Release releases[2];
  if (drain(publisher, at(0ms), releases) != 1) return false;
  publisher.once(0, Level::high, at(20ms));
  if (drain(publisher, at(20ms), releases) != 1 || releases[0].level != Level::high) return false;
  return !publisher.active(0) && publisher.next_release() == base::never;
}
static_assert(once_stops_a_publisher());

constexpr bool a_new_request_replaces_period_and_grid() {
  Publisher<1> publisher;
  publisher.start(0, 100ms, Level::low, at(0ms));
  Release releases[2];
  if (drain(publisher, at(0ms), releases) != 1) return false;
  publisher.start(0, 30ms, Level::high, at(50ms));
  if (drain(publisher, at(50ms), releases) != 1 || releases[0].level != Level::high) return false;
  return publisher.next_release() == at(80ms);
}
static_assert(a_new_request_replaces_period_and_grid());

constexpr bool lateness_is_judged_by_the_jitter() {
  Publisher<1> publisher;
  publisher.start(0, 100ms, Level::medium, at(0ms), 5ms);
  Release releases[2];
  if (drain(publisher, at(5ms), releases) != 1 || releases[0].late) return false;
  return drain(publisher, at(106ms), releases) == 1 && releases[0].late && releases[0].missed == 0;
}
static_assert(lateness_is_judged_by_the_jitter());

constexpr bool a_jitter_below_zero_is_zero_and_a_very_long_one_is_none() {
  const auto late = [](base::Duration jitter, base::Duration after) {
    Publisher<1> publisher;
    publisher.start(0, 1h, Level::medium, at(0ms), jitter);
    Release release;
    return take(publisher, at(after), release) && release.late;
  };
  for (const base::Duration least : {base::Duration{0}, base::Duration{-1}, base::Duration::min()})
    if (late(least, 0ns) || !late(least, 1ns)) return false;
  constexpr base::Duration most{UINT32_MAX - 1};
  if (late(most, most) || !late(most, most + 1ns)) return false;
  for (const base::Duration none : {most + 1ns, most + 2ns, base::Duration{5s}, base::Duration::max()})
    if (late(none, 30min)) return false;
  return true;
}
static_assert(a_jitter_below_zero_is_zero_and_a_very_long_one_is_none());

constexpr bool within_a_priority_the_earliest_grid_point_goes_first() {
  Publisher<3> publisher;
  publisher.start(0, 1s, Level::medium, at(2ms));
  publisher.start(1, 1s, Level::medium, at(1ms));
  publisher.start(2, 1s, Level::medium, at(1ms));
  Release releases[4];
  if (drain(publisher, at(5ms), releases) != 3) return false;
  return releases[0].stream == 1 && releases[1].stream == 2 && releases[2].stream == 0;
}
static_assert(within_a_priority_the_earliest_grid_point_goes_first());

// Whatever is asked for in between: a job is never in two contexts.
constexpr bool what_is_taken_is_not_taken_again() {
  Publisher<1> publisher;
  Release release;
  publisher.start(0, 10ms, Level::low, at(0ms));
  if (!publisher.take_due(at(0ms), Level::low, release)) return false;
  if (publisher.take_due(at(10ms), Level::low, release) || publisher.next_release() != base::never)
    return false;
  publisher.start(0, 10ms, Level::urgent, at(12ms));
  if (publisher.take_due(at(15ms), Level::urgent, release) || publisher.due(at(15ms)).levels != 0)
    return false;
  publisher.done(0, at(15ms));
  if (publisher.due(at(15ms)).levels != 1) return false;
  return publisher.take_due(at(15ms), Level::urgent, release) && release.scheduled == at(12ms);
}
static_assert(what_is_taken_is_not_taken_again());

constexpr bool releases_while_held_are_given_up_and_counted() {
  Publisher<1> publisher;
  Release release;
  publisher.start(0, 10ms, Level::low, at(0ms));
  if (!publisher.take_due(at(0ms), Level::low, release)) return false;
  publisher.hold(0);
  if (publisher.held(Level::low) != 0 || publisher.held(Level::high) != 1) return false;
  if (publisher.overload(0, at(9ms)).overrun != 0 || publisher.overload(0, at(10ms)).overrun != 1)
    return false;
  publisher.done(0, at(31ms));
  if (publisher.overload(0, at(31ms)) != scheduling::Overload{0, 0, 3}) return false;
  if (publisher.overload(at(31ms)) != 3) return false;  // of all streams and kinds
  return publisher.next_release() == at(40ms) && publisher.held(Level::low) == 1;
}
static_assert(releases_while_held_are_given_up_and_counted());

constexpr bool a_single_release_waits_for_what_is_held() {
  Publisher<1> publisher;
  Release release;
  publisher.once(0, Level::low, at(0ms));
  if (!publisher.take_due(at(0ms), Level::low, release)) return false;
  publisher.hold(0);
  publisher.once(0, Level::high, at(5ms));
  if (publisher.take_due(at(6ms), Level::high, release)) return false;
  publisher.done(0, at(7ms));
  return publisher.take_due(at(7ms), Level::high, release) && publisher.overload(0, at(7ms)).overrun == 0;
}
static_assert(a_single_release_waits_for_what_is_held());

constexpr bool overload_is_counted_for_each_stream() {
  Publisher<2> publisher;
  publisher.start(0, 10ms, Level::medium, at(0ms), 1ms);
  publisher.start(1, 100ms, Level::medium, at(0ms), 1ms);
  Release releases[3];
  if (drain(publisher, at(0ms), releases) != 2) return false;
  drain(publisher, at(45ms), releases);  // 10, 20, 30 skipped; 40 late
  if (publisher.overload(0, at(45ms)) != scheduling::Overload{3, 1, 0}) return false;
  publisher.start(0, 10ms, Level::medium, at(46ms));  // a new request does not forget
  return publisher.overload(0, at(46ms)).missed == 3 &&
         publisher.overload(1, at(46ms)) == scheduling::Overload{};
}
static_assert(overload_is_counted_for_each_stream());

constexpr bool due_says_whom_to_call_and_when_to_look_again() {
  Publisher<4> publisher;
  publisher.start(0, 1s, Level::low, at(3ms));
  publisher.start(1, 1s, Level::urgent, at(5ms));
  publisher.start(2, 1s, Level::medium, at(20ms));
  publisher.once(3, Level::high, at(9ms));
  const auto due = publisher.due(at(5ms));
  return due.levels == 0b1001 && due.next == at(9ms);
}
static_assert(due_says_whom_to_call_and_when_to_look_again());

static_assert(sizeof(Publisher<17>) == 17 * 40 + 8);
static_assert(Release{} == Release{0, Level::medium, base::Time{}, 0, false, false});

TEST_CASE("a stop takes effect before the next release") {
  Publisher<2> publisher;
  publisher.start(0, 10ms, Level::medium, at(0ms));
  publisher.start(1, 10ms, Level::medium, at(0ms));
  Release releases[3];
  REQUIRE(drain(publisher, at(0ms), releases) == 2);
  publisher.stop(0);
  REQUIRE(drain(publisher, at(10ms), releases) == 1);
  CHECK(releases[0].stream == 1);
}

TEST_CASE("over a day, however late the caller comes, releases stay on the grid and none is bunched") {
  std::mt19937 random{20180905};
  for (const base::Duration period : {base::Duration{900us}, base::Duration{50ms}, base::Duration{7s}}) {
    Publisher<1> publisher;
    publisher.start(0, period, Level::medium, at(0ms));
    std::uniform_int_distribution<std::int64_t> delay{0, 3 * period.count()};
    base::Time now{};
    std::int64_t served = 0;
    std::int64_t missed = 0;
    base::Time last_scheduled{-period};
    // As many steps as fit into a second of test; the long periods reach over the whole day.
    for (int step = 0; step < 20'000 && now < at(24h); ++step) {
      now = std::max(publisher.next_release(), now) + base::Duration{delay(random)};
      Release releases[3];
      REQUIRE(drain(publisher, now, releases) == 1);
      const auto& release = releases[0];
      REQUIRE(release.scheduled.time_since_epoch() % period == 0ns);
      REQUIRE(release.scheduled <= now);
      REQUIRE(now - release.scheduled < period);
      REQUIRE(release.scheduled - last_scheduled == (release.missed + 1) * period);
      last_scheduled = release.scheduled;
      served += 1;
      missed += release.missed;
    }
    // Every grid point was served or counted.
    CHECK(served + missed == last_scheduled.time_since_epoch() / period + 1);
  }
}

TEST_CASE("a caller that slept for a century neither hangs nor overflows") {
  Publisher<1> publisher;
  publisher.start(0, 1us, Level::medium, at(0ms));
  Release releases[3];
  REQUIRE(drain(publisher, at(100 * 365 * 24h), releases) == 1);
  CHECK(releases[0].missed == UINT32_MAX);
}

}  // namespace scheduling_publisher_test
