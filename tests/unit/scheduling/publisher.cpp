#include "ocm/scheduling/publisher.hpp"

#include <random>

#include <catch2/catch.hpp>

using namespace ocm;
using namespace std::chrono_literals;
using protocol::Priority;
using scheduling::Publisher;
using scheduling::Release;

namespace {

constexpr base::Time at(base::Duration offset) {
  return base::Time{offset};
}

/// All releases that are due at `now`, most urgent first.
template <std::size_t N>
constexpr int drain(Publisher<N>& publisher, base::Time now, Release* releases) {
  int count = 0;
  while (publisher.take_due(now, releases[count])) ++count;
  return count;
}

// The first sample goes out at once; the grid starts at the reception of the request.
constexpr bool releases_on_a_grid() {
  Publisher<1> publisher;
  publisher.start(0, 500ms, Priority::medium, at(100ms));
  Release release;
  if (!publisher.take_due(at(100ms), release) || release.scheduled != at(100ms)) return false;
  if (publisher.take_due(at(599ms), release)) return false;
  // 30 ms late: the thesis's publisher, which slept after its work, would go on at 1130 ms. [Thesis 7.1]
  if (!publisher.take_due(at(630ms), release) || release.scheduled != at(600ms)) return false;
  return publisher.next_release() == at(1100ms);
}
static_assert(releases_on_a_grid());

constexpr bool skips_whole_periods() {
  Publisher<1> publisher;
  publisher.start(0, 100ms, Priority::medium, at(0ms));
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
  publisher.start(0, 1s, Priority::low, at(0ms));
  publisher.start(1, 1s, Priority::urgent, at(0ms));
  publisher.start(2, 1s, Priority::medium, at(0ms));
  publisher.start(3, 1s, Priority::urgent, at(0ms));
  Release releases[5];
  if (drain(publisher, at(0ms), releases) != 4) return false;
  return releases[0].stream == 1 && releases[1].stream == 3 && releases[2].stream == 2 &&
         releases[3].stream == 0;
}
static_assert(urgent_goes_first());

constexpr bool once_stops_a_publisher() {  // thesis figure 5.2
  Publisher<1> publisher;
  publisher.start(0, 100ms, Priority::medium, at(0ms));
  Release releases[2];
  if (drain(publisher, at(0ms), releases) != 1) return false;
  publisher.once(0, Priority::high, at(20ms));
  if (drain(publisher, at(20ms), releases) != 1 || releases[0].priority != Priority::high) return false;
  return !publisher.active(0) && publisher.next_release() == base::never;
}
static_assert(once_stops_a_publisher());

constexpr bool a_new_request_replaces_period_and_grid() {
  Publisher<1> publisher;
  publisher.start(0, 100ms, Priority::low, at(0ms));
  Release releases[2];
  if (drain(publisher, at(0ms), releases) != 1) return false;
  publisher.start(0, 30ms, Priority::high, at(50ms));
  if (drain(publisher, at(50ms), releases) != 1 || releases[0].priority != Priority::high) return false;
  return publisher.next_release() == at(80ms);
}
static_assert(a_new_request_replaces_period_and_grid());

constexpr bool lateness_is_judged_by_the_jitter() {
  Publisher<1> publisher;
  publisher.start(0, 100ms, Priority::medium, at(0ms), 5ms);
  Release releases[2];
  if (drain(publisher, at(5ms), releases) != 1 || releases[0].late) return false;
  return drain(publisher, at(106ms), releases) == 1 && releases[0].late && releases[0].missed == 0;
}
static_assert(lateness_is_judged_by_the_jitter());

}  // namespace

TEST_CASE("a stop takes effect before the next release") {
  Publisher<2> publisher;
  publisher.start(0, 10ms, Priority::medium, at(0ms));
  publisher.start(1, 10ms, Priority::medium, at(0ms));
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
    publisher.start(0, period, Priority::medium, at(0ms));
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
  publisher.start(0, 1us, Priority::medium, at(0ms));
  Release releases[3];
  REQUIRE(drain(publisher, at(100 * 365 * 24h), releases) == 1);
  CHECK(releases[0].missed == UINT32_MAX);
}
