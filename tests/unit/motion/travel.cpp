#include "ocm/motion/travel.hpp"

#include <limits>

#include <catch2/catch.hpp>

#include "unit/base/explore.hpp"
#include "unit/base/random.hpp"
#include "unit/motion/near.hpp"

namespace motion_travel_test {

using namespace ocm::motion;
using ocm::test::near;
using ocm::test::Random;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float dt_s = 0.02F;
constexpr TravelModel model{.wheelbase_m = 0.07F};

// 0.3 m at 0.1 m/s take 3 s; a quarter turn moves a wheel 0.035 * pi/2 m.
static_assert(near(duration_s({0.3F, 0.0F, 0.1F}, model), 3.0F));
static_assert(near(duration_s({-0.3F, 0.0F, 0.1F}, model), 3.0F));
static_assert(near(duration_s({0.3F, -pi / 2.0F, 0.1F}, model), 3.0F + 0.35F * pi / 2.0F));
static_assert(near(longest_s({0.3F, 0.0F, 0.1F}, model), 2.0F * 3.0F + 5.0F));
static_assert(duration_s({0.3F, 1.0F, 0.1F}, {}) == duration_s({0.3F, 0.0F, 0.1F}, {}), "no wheelbase");
static_assert(duration_s({0.3F, 0.0F, 0.0F}, model) == 0.0F && duration_s({nan, 0.0F, 0.1F}, model) == 0.0F);

// What cannot be done is not begun.
static_assert(started({0.3F, 0.0F, 0.0F}, model).phase == Travel::Phase::idle);
static_assert(started({0.3F, 0.0F, -0.1F}, model).phase == Travel::Phase::idle);
static_assert(started({nan, 0.0F, 0.1F}, model).phase == Travel::Phase::idle);
static_assert(started({0.3F, infinity, 0.1F}, model).phase == Travel::Phase::idle);
static_assert(control(Travel{}, {0.1F, 0.1F}, dt_s, model).command == Twist{});

// It sets off on a ramp: 1 m/s2 is 0.02 m/s in a step of 20 ms.
constexpr TravelStep first = control(started({0.3F, 0.0F, 0.1F}, model), {}, dt_s, model);
static_assert(near(first.command.speed_m_s, 0.02F) && first.command.turn_rad_s == 0.0F);
static_assert(control(started({-0.3F, 0.0F, 0.1F}, model), {}, dt_s, model).command.speed_m_s < 0.0F);
constexpr TravelStep turns = control(started({0.0F, -1.0F, 0.1F}, model), {}, dt_s, model);
static_assert(turns.command.speed_m_s == 0.0F && near(turns.command.turn_rad_s, -0.02F / 0.035F));

// A robot that is turned off its way is turned back, and its way counts for less.
constexpr TravelStep off = control(started({0.3F, 0.0F, 0.1F}, model), {0.1F, 0.2F}, dt_s, model);
static_assert(off.command.turn_rad_s < 0.0F);
static_assert(near(off.state.distance_left_m, 0.3F - 0.1F * (1.0F - 0.005F)));

// No numbers, no motion; and it is counted.
static_assert(control(first.state, {nan, 0.0F}, dt_s, model).command == Twist{});
static_assert(control(first.state, {0.0F, infinity}, dt_s, model).state.rejected == 1);
static_assert(control(first.state, {}, 0.0F, model).state.rejected == 1);

// A step without numbers is a stop: it sets off again on the ramp, not at the speed that it had.
constexpr TravelStep faster = control(first.state, {}, dt_s, model);
static_assert(near(faster.command.speed_m_s, 0.04F));
constexpr TravelStep after_nonsense =
    control(control(faster.state, {nan, 0.0F}, dt_s, model).state, {}, dt_s, model);
static_assert(near(after_nonsense.command.speed_m_s, 0.02F));

// The way counts by the angle at which the robot was in the middle of the step: 0.3 + 0.2 / 2 = 0.4.
constexpr Travel askew = control(started({0.3F, 0.0F, 0.1F}, model), {0.0F, 0.3F}, dt_s, model).state;
static_assert(near(control(askew, {0.1F, 0.2F}, dt_s, model).state.distance_left_m, 0.3F - 0.1F * 0.92F));

// Turned by more than a radian, to either side, the way counts for half.
constexpr Travel turned_left = control(started({0.3F, 0.0F, 0.1F}, model), {0.0F, 2.0F}, dt_s, model).state;
constexpr Travel turned_right = control(started({0.3F, 0.0F, 0.1F}, model), {0.0F, -2.0F}, dt_s, model).state;
static_assert(near(control(turned_left, {0.1F, 0.0F}, dt_s, model).state.distance_left_m, 0.25F));
static_assert(near(control(turned_right, {0.1F, 0.0F}, dt_s, model).state.distance_left_m, 0.25F));

/// With numbers that a float holds exactly, to see what holds at a bound.
constexpr TravelModel exact{.wheelbase_m = 0.5F,
                            .distance_tolerance_m = 0.25F,
                            .angle_tolerance_rad = 0.25F,
                            .settled_steps = 1,
                            .patience = 0.0F,
                            .patience_s = 0.5F};
constexpr TravelEnd end_of(const TravelTarget& target, const TravelModel& with) {
  return control(started(target, with), {}, 0.25F, with).end;
}
static_assert(end_of({0.25F, 0.0F, 1.0F}, exact) == TravelEnd::arrived, "the tolerance is within it");
static_assert(end_of({-0.25F, 0.0F, 1.0F}, exact) == TravelEnd::arrived);
static_assert(end_of({0.28125F, 0.0F, 1.0F}, exact) == TravelEnd::none);
static_assert(end_of({0.0F, 0.25F, 1.0F}, exact) == TravelEnd::arrived);
static_assert(end_of({0.0F, -0.28125F, 1.0F}, exact) == TravelEnd::none);

/// How many steps of a robot that does not move it takes until the end; 0: more than ten.
constexpr int steps_until(TravelEnd end, const TravelTarget& target, const TravelModel& with) {
  Travel state = started(target, with);
  for (int i = 1; i <= 10; ++i) {
    const TravelStep step = control(state, {}, 0.25F, with);
    if (step.end != TravelEnd::none) return step.end == end ? i : -1;
    state = step.state;
  }
  return 0;
}
static_assert(steps_until(TravelEnd::too_long, {1.0F, 0.0F, 1.0F}, exact) == 3,
              "half a second is not too long");
// Within tolerance of both from the start: three steps for the way; the third is the first of the turn.
static_assert(steps_until(TravelEnd::arrived, {0.0005F, 0.0F, 0.1F}, model) == 3);
static_assert(steps_until(TravelEnd::arrived, {0.0F, 0.005F, 0.1F}, model) == 3);
static_assert(steps_until(TravelEnd::arrived, {0.0005F, 0.005F, 0.1F}, model) == 5);

// What it has turned on the way is a part of the turn: 1 rad to the left, 0.3 of it are done, 0.7 are left.
constexpr TravelStep round_the_corner =
    control(started({1.0F, 1.0F, 1.0F}, exact), {0.9F, 0.3F}, 0.25F, exact);
static_assert(round_the_corner.state.phase == Travel::Phase::turning);
static_assert(near(round_the_corner.state.angle_left_rad, 0.7F));
static_assert(round_the_corner.command.speed_m_s == 0.0F && round_the_corner.command.turn_rad_s > 0.0F);

// It turns where it is: of the speed that it had on the way nothing is left.
constexpr TravelStep on_the_way = control(started({1.0F, 1.0F, 1.0F}, exact), {0.5F, 0.0F}, 0.25F, exact);
static_assert(on_the_way.command == Twist{0.25F, 0.0F});
static_assert(control(on_the_way.state, {0.5F, 0.0F}, 0.125F, exact).command == Twist{0.0F, 0.5F});

// Nothing is left of it at its end, and what was never begun is at rest.
constexpr TravelStep ended = control(started({0.25F, 0.0F, 1.0F}, exact), {}, 0.25F, exact);
static_assert(ended.command == Twist{} && ended.state.last == Twist{});
static_assert(control(ended.state, {}, 0.25F, exact).end == TravelEnd::none, "said once");
constexpr TravelStep from_speed =
    control(control(started({1.0F, 0.0F, 1.0F}, exact), {0.5F, 0.0F}, 0.25F, exact).state, {0.5F, 0.0F},
            0.125F, exact);
static_assert(from_speed.end == TravelEnd::arrived && from_speed.state.last == Twist{});
constexpr bool at_rest(const Travel& state) {
  return state.phase == Travel::Phase::idle && state.settled == 0 && state.distance_left_m == 0.0F &&
         state.angle_left_rad == 0.0F && state.heading_rad == 0.0F && state.speed_m_s == 0.0F &&
         state.left_s == 0.0F && state.last == Twist{} && state.rejected == 0;
}
static_assert(at_rest({}) && at_rest(started({}, model)) && TravelTarget{} == TravelTarget{0.0F, 0.0F, 0.0F});

/// Wheels that follow with a lag, without slip.
struct Robot {
  Twist speed{};
  float lag_s = 0.05F;
  float way_m = 0.0F;
  float heading_rad = 0.0F;
  constexpr Moved step(Twist command) {
    Moved moved;
    for (int i = 0; i < 20; ++i) {
      speed.speed_m_s += (command.speed_m_s - speed.speed_m_s) * 0.001F / lag_s;
      speed.turn_rad_s += (command.turn_rad_s - speed.turn_rad_s) * 0.001F / lag_s;
      moved.ahead_m += speed.speed_m_s * 0.001F;
      moved.turn_rad += speed.turn_rad_s * 0.001F;
    }
    way_m += moved.ahead_m;
    heading_rad += moved.turn_rad;
    return moved;
  }
};

struct Run {
  TravelEnd end = TravelEnd::none;
  float time_s = 0.0F;
  float furthest_m = 0.0F;  // in the direction of the target
  float fastest_m_s = 0.0F;
  Robot robot{};
};
Run run(const TravelTarget& target, Robot robot, bool blocked = false) {
  Run result;
  Travel state = started(target, model);
  Moved moved;
  while (result.end == TravelEnd::none && result.time_s < 10'000.0F) {
    const TravelStep step = control(state, moved, dt_s, model);
    state = step.state;
    result.end = step.end;
    moved = robot.step(step.command);
    if (blocked) moved = {};
    result.time_s += dt_s;
    const float way = target.distance_m < 0.0F ? -robot.way_m : robot.way_m;
    if (way > result.furthest_m) result.furthest_m = way;
    const float wheel = magnitude(step.command.speed_m_s) + magnitude(step.command.turn_rad_s) * 0.035F;
    if (wheel > result.fastest_m_s) result.fastest_m_s = wheel;
  }
  for (int i = 0; i < 50; ++i) robot.step({});  // it rolls out
  result.robot = robot;
  return result;
}

TEST_CASE("a travel ends where it should, as fast as it may, and does not run over its end") {
  Random random{1};
  for (int i = 0; i < 300 / ocm::test::coarser(10); ++i) {
    CAPTURE(i);
    const auto within = [&random](float low, float high) {
      return low + (high - low) * static_cast<float>(random.below(10'001)) / 10'000.0F;
    };
    const TravelTarget target{within(-2.0F, 2.0F), i % 3 == 0 ? 0.0F : within(-10.0F, 10.0F),
                              within(0.02F, 0.3F)};
    const Run done = run(target, {.lag_s = within(0.01F, 0.07F)});
    CHECK(done.end == TravelEnd::arrived);
    CHECK(near(done.robot.way_m, target.distance_m, 0.0012F));
    CHECK(near(done.robot.heading_rad, target.angle_rad, 0.012F));
    CHECK(done.furthest_m <= magnitude(target.distance_m) + 0.0012F);
    CHECK(done.fastest_m_s <= target.speed_m_s + 1e-4F);
    CHECK(done.time_s <= duration_s(target, model) + 5.0F);
  }
}

TEST_CASE("turning back to the way goes first: no wheel is asked for more than the speed") {
  for (const float way_m : {1.0F, -1.0F}) {
    Travel state = started({way_m, 0.0F, 0.1F}, model);
    Moved pushed{0.0F, 0.8F};  // it is kicked round
    float turn_rad_s = 0.0F;
    for (int i = 0; i < 100; ++i) {
      const TravelStep step = control(state, pushed, dt_s, model);
      pushed = {};
      state = step.state;
      turn_rad_s = step.command.turn_rad_s;
      REQUIRE(magnitude(step.command.speed_m_s) + magnitude(turn_rad_s) * 0.035F <= 0.1F + 1e-6F);
    }
    // 2.5/s of 0.8 rad are 2 rad/s, 0.07 m/s of a wheel: 0.03 m/s are left for the way.
    CHECK(near(turn_rad_s, -2.0F));
    CHECK(near(state.last.speed_m_s, way_m < 0.0F ? -0.03F : 0.03F));
  }
}

TEST_CASE("wheels that do not turn end it") {
  const TravelTarget target{0.3F, 1.0F, 0.1F};
  const Run done = run(target, {}, true);
  CHECK(done.end == TravelEnd::too_long);
  CHECK(done.time_s > longest_s(target, model));
  CHECK(done.time_s < longest_s(target, model) + 0.1F);
}

TEST_CASE("any numbers leave the command within its bounds") {
  Random random{2};
  Travel state = started({1.0F, 1.0F, 0.2F}, model);
  for (int i = 0; i < 20'000; ++i) {
    const auto any = [&random] {
      switch (random.below(8)) {
        case 0:
          return nan;
        case 1:
          return infinity;
        case 2:
          return std::numeric_limits<float>::max();
        default:
          return (static_cast<float>(random.below(2001)) - 1000.0F) / 1000.0F;
      }
    };
    const TravelStep step = control(state, {any(), any()}, any(), model);
    REQUIRE(magnitude(step.command.speed_m_s) <= 0.2F);
    REQUIRE(magnitude(step.command.turn_rad_s) <= 0.2F / 0.035F + 1e-4F);
    state = step.state;
    if (state.phase == Travel::Phase::idle || !all_finite(state.distance_left_m, state.angle_left_rad))
      state = started({1.0F, 1.0F, 0.2F}, model);
  }
}

}  // namespace motion_travel_test
