#include "ocm/controller/watchdog.hpp"

#include <catch2/catch.hpp>

namespace controller_watchdog_test {

using namespace ocm;
using namespace std::chrono_literals;

constexpr bool expires_once() {
  controller::Watchdog watchdog{500ms};
  const base::Time start{};
  if (watchdog.expire(start + 1h)) return false;  // never fed: nothing moves
  watchdog.feed(start);
  if (watchdog.expire(start + 499ms) || !watchdog.expire(start + 500ms)) return false;
  return !watchdog.expire(start + 501ms);
}
static_assert(expires_once());

constexpr bool the_shortest_expires() {
  controller::Watchdog watchdog{1ns};
  watchdog.feed(base::Time{1s});
  return watchdog.expires_at() == base::Time{1s + 1ns} && watchdog.timeout() == 1ns &&
         watchdog.expire(base::Time{1s + 1ns});
}
static_assert(the_shortest_expires());

constexpr bool zero_never_expires() {
  controller::Watchdog watchdog{0ms};
  watchdog.feed(base::Time{});
  return !watchdog.expire(base::Time{24h}) && watchdog.expires_at() == base::never;
}
static_assert(zero_never_expires());

TEST_CASE("each command buys another timeout") {
  controller::Watchdog watchdog{500ms};
  for (int i = 0; i < 10; ++i) {
    watchdog.feed(base::Time{i * 400ms});
    CHECK_FALSE(watchdog.expire(base::Time{i * 400ms + 399ms}));
  }
  CHECK(watchdog.expire(base::Time{9 * 400ms + 500ms}));
}

}  // namespace controller_watchdog_test
