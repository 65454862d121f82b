#include "ocm/reflective/limits.hpp"

#include <chrono>
#include <random>

#include <catch2/catch.hpp>

namespace reflective_limits_test {

using namespace ocm;
using namespace ocm::reflective;
using namespace std::chrono_literals;

constexpr Limit limit{.topic = 3, .field = 1, .min = -100, .max = 200, .per_second = 1000};
static_assert(change_within(limit, 10ms) == 10);
static_assert(change_within(limit, 999us) == 0);
static_assert(change_within(limit, 2500ms) == 2500);
static_assert(change_within(Limit{.per_second = INT64_MAX}, 5s) == INT64_MAX);
static_assert(change_within(Limit{}, 0ns) == INT64_MAX);  // at once
static_assert(limited(limit, 50, 0, 10ms) == 10);
static_assert(limited(limit, -50, 0, 10ms) == -10);
static_assert(limited(limit, 5, 0, 10ms) == 5);
static_assert(limited(limit, 500, 0, 10s) == 200);
static_assert(limited(limit, 500, 0, -1s) == 0);  // a clock that goes back moves nothing

constexpr Limit limits[] = {limit};

TEST_CASE("limits: a set point comes up as fast as it may, from rest or from what was commanded") {
  const base::Time start{1s};
  Limiter<4> limiter;
  limiter.enter(limits);
  std::int64_t raw[] = {7, 150};
  CHECK(limiter.permit(3, raw, start) == 1);
  CHECK(raw[1] == 0);
  CHECK(raw[0] == 7);
  raw[1] = 150;
  CHECK(limiter.permit(3, raw, start + 100ms) == 1);
  CHECK(raw[1] == 100);
  raw[1] = 150;
  CHECK(limiter.permit(3, raw, start + 200ms) == 0);
  CHECK(raw[1] == 150);

  const std::int64_t zero[] = {0, 0};
  limiter.commanded(3, zero, start + 300ms);
  raw[1] = 150;
  limiter.permit(3, raw, start + 310ms);
  CHECK(raw[1] == 10);

  raw[1] = 150;
  limiter.permit(3, raw, start + 20s);  // not commanded for a while: no jump
  CHECK(raw[1] == 110);

  std::int64_t other[] = {7, 9999};
  CHECK(limiter.permit(4, other, start) == 0);  // another topic has no limit
  CHECK(other[1] == 9999);
  limiter.enter({});
  CHECK(limiter.permit(3, other, start) == 0);
}

TEST_CASE("limits: however often it is commanded, never faster, and not stuck") {
  std::mt19937 random{3};
  for (int run = 0; run < 200; ++run) {
    Limiter<4> limiter;
    limiter.enter(limits);
    base::Time now{1s};
    const base::Time start = now;
    std::int64_t raw[] = {0, 200};
    limiter.permit(3, raw, now);
    std::int64_t last = raw[1];
    const auto step = base::Duration{1 + static_cast<std::int64_t>(random() % 5'000'000)};
    while (now < start + 1s) {
      now += step;
      raw[1] = 200;
      limiter.permit(3, raw, now);
      if (raw[1] < last || raw[1] > 200) FAIL("not on its way");
      if (raw[1] > (now - start).count() / 1'000'000) FAIL("too fast");
      last = raw[1];
      if (step < 20us && now > start + 20ms) break;  // tiny steps: long enough
    }
    if (now - start >= 20ms) CHECK(last > 0);
  }
}

}  // namespace reflective_limits_test
