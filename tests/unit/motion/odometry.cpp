#include "ocm/motion/odometry.hpp"

#include <cmath>
#include <cstdint>
#include <limits>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"
#include "unit/motion/near.hpp"

namespace motion_odometry_test {

using namespace ocm::motion;
using ocm::test::near;
using ocm::test::near_angle;
using ocm::test::Random;

static_assert(ticks_between(10, 13) == 3 && ticks_between(13, 10) == -3);
static_assert(ticks_between(0xFFFF'FFFE, 1) == 3, "across the wrap, forwards");
static_assert(ticks_between(1, 0xFFFF'FFFE) == -3, "and backwards");

// One tick is 1 mm, the wheels stand 100 mm apart: 60 and 40 ticks are 50 mm ahead and 0.2 rad to the right.
constexpr Drive drive{.wheel_radius_m = 0.1F / two_pi, .wheelbase_m = 0.1F, .ticks_per_turn = 100.0F};
static_assert(near(advance(60, 40, drive).distance_m, 0.050F) &&
              near(advance(60, 40, drive).turn_rad, -0.2F));

constexpr WheelCounts from(std::uint32_t left, std::uint32_t right) {
  return {.left = left, .right = right, .rejected = 0, .started = true};
}

static_assert(count({}, 5000, 7000, 10, drive).advance == Advance{}, "the first counts are the start");
static_assert(count({}, 5000, 7000, 10, drive).counts == from(5000, 7000));
static_assert(near(count(from(0xFFFF'FFFB, 0), 5, 10, 10, drive).advance.distance_m, 0.010F));
static_assert(near(count(from(0, 20), 10, 10, 10, drive).advance.turn_rad, -0.2F), "the bound is possible");
static_assert(count(from(0, 20), 10, 10, 10, drive).counts.rejected == 0);
static_assert(count(from(0, 20), 11, 10, 10, drive).counts.rejected == 1 &&
              count(from(0, 20), 10, 9, 10, drive).counts.rejected == 1);
static_assert(count(from(0, 0), 11, 0, 10, drive).counts.rejected == 1);
static_assert(WheelCounts{} == WheelCounts{0, 0, 0, false} && Advance{} == Advance{0.0F, 0.0F});
static_assert(count(from(0, 0), 0, 0xFFFF'FFF0, 10, drive).counts.rejected == 1);
static_assert(count(from(5000, 5000), 0, 0, 10, drive).advance == Advance{}, "a counter that was reset");
static_assert(count(from(0, 0), 11, 0, 10, drive).counts.left == 11, "and the next step starts there");
static_assert(count(from(0, 0), 0x8000'0000, 0, 10, drive).counts.rejected == 1);

constexpr std::uint32_t directed() {
  DirectedTicks ticks;
  ticks.pulses(7);  // direction not known
  ticks.command(DirectedTicks::Direction::forward);
  ticks.pulses(5);
  ticks.command(DirectedTicks::Direction::unknown);  // a stop: the wheel rolls on
  ticks.pulses(2);
  ticks.command(DirectedTicks::Direction::backward);
  ticks.pulses(3);
  return ticks.count() * 100 + ticks.undirected();
}
static_assert(directed() == 407);

TEST_CASE("straight on, and turning on the spot", "[motion]") {
  CHECK(near(moved({1.0F, 2.0F, 0.0F}, {0.5F, 0.0F}), {1.5F, 2.0F, 0.0F}, 1e-6F, 1e-6F));
  CHECK(near(moved({1.0F, 2.0F, pi / 2.0F}, {0.5F, 0.0F}), {1.0F, 2.5F, pi / 2.0F}, 1e-6F, 1e-6F));
  CHECK(near(moved({1.0F, 2.0F, 3.0F}, {0.0F, 0.5F}), {1.0F, 2.0F, 3.5F - two_pi}, 1e-6F, 1e-6F));
}

TEST_CASE("equal ticks turn nothing, on every processor", "[motion]") {
  for (std::int32_t ticks = -1000; ticks <= 1000; ++ticks)
    REQUIRE(advance(ticks, ticks, drive).turn_rad == 0.0F);
}

TEST_CASE("one step of an arc, by hand", "[motion]") {
  // th = 0, d = 1, dth = pi/2: along pi/4, x = y = cos(pi/4) = 0.70711. [T2 eq. 2.4]
  CHECK(near(moved({}, {1.0F, pi / 2.0F}), {0.70711F, 0.70711F, pi / 2.0F}, 1e-5F, 1e-6F));
}

TEST_CASE("random arcs in small steps end where the circle does", "[motion]") {
  Random random{2};
  for (int round = 0; round < 300; ++round) {
    const Pose start{static_cast<float>(random.within(-100, 100)) / 100.0F,
                     static_cast<float>(random.within(-100, 100)) / 100.0F,
                     static_cast<float>(random.within(-314, 314)) / 100.0F};
    const float radius = static_cast<float>(random.within(5, 200)) / 100.0F;
    const float angle = static_cast<float>(random.within(-600, 600)) / 100.0F;
    constexpr int steps = 400;
    Pose pose = start;
    for (int i = 0; i < steps; ++i) {
      pose = moved(pose, {radius * angle / steps, angle / steps});
      REQUIRE((pose.heading_rad > -pi && pose.heading_rad <= pi));
    }
    // A circle to the left of radius r: x = x0 + r (sin(th) - sin(th0)), y = y0 - r (cos(th) - cos(th0)).
    const double th0 = start.heading_rad;
    const double th = th0 + angle;
    const Pose end{static_cast<float>(start.x_m + radius * (std::sin(th) - std::sin(th0))),
                   static_cast<float>(start.y_m - radius * (std::cos(th) - std::cos(th0))),
                   wrap(static_cast<float>(th))};
    CAPTURE(round, radius, angle, pose.x_m, end.x_m, pose.y_m, end.y_m);
    REQUIRE(near(pose, end, 3e-4F, 1e-4F));
  }
}

TEST_CASE("there and back again by the same ticks is where it began", "[motion]") {
  Random random{3};
  Pose pose{0.3F, -0.2F, 1.0F};
  Advance steps[200];
  for (Advance& step : steps) {
    step = advance(random.within(-20, 20), random.within(-20, 20), drive);
    pose = moved(pose, step);
  }
  for (int i = 199; i >= 0; --i) pose = moved(pose, {-steps[i].distance_m, -steps[i].turn_rad});
  CHECK(near(pose, {0.3F, -0.2F, 1.0F}, 1e-4F, 1e-4F));
}

TEST_CASE("an advance that is not finite does not move a pose", "[motion]") {
  const Pose pose{1.0F, 2.0F, 3.0F};
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  constexpr float infinity = std::numeric_limits<float>::infinity();
  CHECK(moved(pose, {nan, 0.0F}) == pose);
  CHECK(moved(pose, {0.1F, nan}) == pose);
  CHECK(moved(pose, {infinity, 0.0F}) == pose);
  CHECK(moved(pose, {0.0F, -infinity}) == pose);
}

}  // namespace motion_odometry_test
