#include "ocm/reflective/limits.hpp"

#include <array>
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
static_assert(change_within(limit, 1s) == 1000 && change_within(limit, 1s - 1ns) == 999);
static_assert(change_within(Limit{}, 0ns) == INT64_MAX);  // at once
// Products that do not fit in 64 bits: rounded down to what a nanosecond makes.
static_assert(change_within(Limit{.per_second = 10'000'000'000}, 500ms) == 5'000'000'000);
static_assert(change_within(Limit{.per_second = INT64_MAX}, 500ms) == 4'611'686'018'000'000'000);
static_assert(change_within(Limit{.per_second = INT64_MAX}, 1500ms) == INT64_MAX);
static_assert(limited(limit, 50, 0, 10ms) == 10);
static_assert(limited(limit, -50, 0, 10ms) == -10);
static_assert(limited(limit, 5, 0, 10ms) == 5);
static_assert(limited(limit, 500, 0, 10s) == 200);
static_assert(limited(limit, 500, 0, -1s) == 0);  // a clock that goes back moves nothing
constexpr Limit fast{.topic = 3, .field = 1, .min = -100, .max = 200, .per_second = 2'000'000'000};
static_assert(limited(fast, 50, 0, 1ns) == 2 && limited(fast, 50, 0, -1s) == 0);
static_assert(longest_pause == 100ms);  // decided

// At once, from anywhere to anywhere.
constexpr Limit any{.min = INT64_MIN, .max = INT64_MAX};
static_assert(limited(any, INT64_MIN, -5, 0ns) == INT64_MIN && limited(any, INT64_MAX, 5, 0ns) == INT64_MAX);
static_assert(limited(any, INT64_MIN, INT64_MAX, 0ns) == 0);  // but for so far in one step

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

TEST_CASE("limits: the first set point is at rest, however fast it may change") {
  const std::array<Limit, 1> limits_of_fast{fast};
  Limiter<1> limiter;
  limiter.enter(limits_of_fast);
  std::int64_t raw[] = {0, 150};
  limiter.permit(3, raw, base::Time{1s});
  CHECK(raw[1] == 0);
}

TEST_CASE("limits: not even the time that one step takes is saved up") {
  const base::Time start{1s};
  Limiter<1> limiter;
  limiter.enter(limits);
  const auto at = [&](base::Duration after, std::int64_t wanted) {
    std::int64_t raw[] = {0, wanted};
    limiter.permit(3, raw, start + after);
    return raw[1];
  };
  CHECK(at(0ms, 0) == 0);
  CHECK(at(1ms, 0) == 0);
  CHECK(at(1500us, 200) == 0);
  CHECK(at(2ms, 200) == 1);
}

TEST_CASE("limits: time in which it asks for no more is not saved up") {
  const base::Time start{1s};
  Limiter<1> limiter;
  limiter.enter(limits);
  const auto at = [&](base::Duration after, std::int64_t wanted) {
    std::int64_t raw[] = {0, wanted};
    limiter.permit(3, raw, start + after);
    return raw[1];
  };
  CHECK(at(0ms, 0) == 0);
  CHECK(at(50ms, 0) == 0);
  CHECK(at(60ms, 200) == 10);
  // In steps of less than it may change by in whole numbers it comes up all the same.
  CHECK(at(60ms + 400us, 200) == 10);
  CHECK(at(60ms + 800us, 200) == 10);
  CHECK(at(61ms, 200) == 11);
  // What was sent beyond a limit is back within it at once, and goes on from then.
  const std::int64_t beyond[] = {0, 500};
  limiter.commanded(3, beyond, start + 70ms);
  CHECK(at(70ms + 500us, 100) == 200);
  CHECK(at(71ms, 100) == 200);
  CHECK(at(71ms + 500us, 100) == 199);
}

TEST_CASE("limits: each of several has its own, those of topics and fields that a set point has") {
  const base::Time start{1s};
  const Limit several[] = {{.topic = 3, .field = 0, .min = -10, .max = 10},
                           {.topic = 5, .field = 0, .min = -20, .max = 20},
                           {.topic = 3, .field = 1, .min = -30, .max = 30, .per_second = 1000}};
  Limiter<3> limiter;
  limiter.enter(several);
  std::int64_t raw[] = {99, 99};
  CHECK(limiter.permit(3, raw, start) == 2);
  CHECK((raw[0] == 10 && raw[1] == 0));
  raw[0] = raw[1] = -99;
  CHECK(limiter.permit(5, raw, start) == 1);
  CHECK((raw[0] == -20 && raw[1] == -99));
  std::int64_t one[] = {5};
  CHECK(limiter.permit(3, one, start) == 0);  // without the second field
  // A field that is not given is 0, and that of another topic no news.
  const std::int64_t two[] = {7, 20};
  limiter.commanded(3, two, start);
  limiter.commanded(5, two, start + 5ms);
  raw[1] = 99;
  limiter.permit(3, raw, start + 5ms);
  CHECK(raw[1] == 25);
  limiter.commanded(3, one, start + 5ms);
  raw[1] = 99;
  limiter.permit(3, raw, start + 10ms);
  CHECK(raw[1] == 5);
  // Entered again it starts from rest.
  limiter.enter(several);
  raw[1] = 99;
  limiter.permit(3, raw, start + 11ms);
  CHECK(raw[1] == 0);
  // One that has less room holds the first ones.
  Limiter<2> less;
  less.enter(several);
  raw[0] = raw[1] = 99;
  CHECK(less.permit(3, raw, start) == 1);
  CHECK((raw[0] == 10 && raw[1] == 99));
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
