#include "ocm/motion/pose.hpp"

#include <cmath>
#include <limits>

#include <catch2/catch.hpp>

#include "unit/motion/near.hpp"

namespace motion_pose_test {

using namespace ocm::motion;
using ocm::test::near;

constexpr Drive drive{.wheel_radius_m = 0.05F, .wheelbase_m = 0.2F, .ticks_per_turn = 198.0F};
static_assert(drive.valid() && !Drive{}.valid());

constexpr bool invalid(float Drive::*number, float value) {
  Drive changed = drive;
  changed.*number = value;
  return !changed.valid();
}
constexpr bool needed(float Drive::*number) {
  return invalid(number, 0.0F) && invalid(number, -1.0F) &&
         invalid(number, std::numeric_limits<float>::infinity()) &&
         invalid(number, std::numeric_limits<float>::quiet_NaN()) && !invalid(number, 1e-3F);
}
static_assert(needed(&Drive::wheel_radius_m) && needed(&Drive::wheelbase_m) &&
              needed(&Drive::ticks_per_turn));

// What is not given is at the origin, looks along x, and stands.
static_assert(Point{} == Point{0.0F, 0.0F} && Pose{} == Pose{0.0F, 0.0F, 0.0F} &&
              Twist{} == Twist{0.0F, 0.0F});
static_assert(WheelSpeeds{} == WheelSpeeds{0.0F, 0.0F});
static_assert(Drive{}.wheel_radius_m == 0.0F && Drive{}.wheelbase_m == 0.0F &&
              Drive{}.ticks_per_turn == 0.0F);
static_assert(is_finite(Pose{1.0F, 2.0F, 3.0F}));
static_assert(!is_finite(Pose{std::numeric_limits<float>::infinity(), 0.0F, 0.0F}) &&
              !is_finite(Pose{0.0F, std::numeric_limits<float>::infinity(), 0.0F}) &&
              !is_finite(Pose{0.0F, 0.0F, std::numeric_limits<float>::infinity()}));
static_assert(near(drive.m_per_tick(), 0.00158666F, 1e-7F));  // 2 pi 50 mm / 198

// By hand, eq. 2.3: v = 0.025 (4 + 2) = 0.15 m/s, w = 0.25 (4 - 2) = 0.5 rad/s.
static_assert(near(twist({2.0F, 4.0F}, drive).speed_m_s, 0.15F));
static_assert(near(twist({2.0F, 4.0F}, drive).turn_rad_s, 0.5F));
static_assert(near(wheel_speeds({0.15F, 0.5F}, drive).left_rad_s, 2.0F));
static_assert(near(wheel_speeds({0.15F, 0.5F}, drive).right_rad_s, 4.0F));

TEST_CASE("a point as a robot sees it that looks neither along x nor along y", "[motion]") {
  // cos = 0.8, sin = 0.6: x = 1 + 0.8 * 0.5 - 0.6 * 0.25 = 1.25, y = 2 + 0.6 * 0.5 + 0.8 * 0.25 = 2.5.
  const Pose robot{1.0F, 2.0F, std::atan2(0.6F, 0.8F)};
  const Point world = to_world(robot, {0.5F, 0.25F});
  CHECK(near(world.x_m, 1.25F));
  CHECK(near(world.y_m, 2.5F));
  const Point seen = to_robot(robot, {1.25F, 2.5F});
  CHECK(near(seen.x_m, 0.5F));
  CHECK(near(seen.y_m, 0.25F));
  // Its own place is its origin.
  CHECK(to_world(robot, {}) == Point{1.0F, 2.0F});
  CHECK(to_robot(robot, {1.0F, 2.0F}) == Point{});
}

TEST_CASE("a point ahead of a robot that looks left lies to the left in the world", "[motion]") {
  const Pose robot{1.0F, 2.0F, pi / 2.0F};
  const Point world = to_world(robot, {0.5F, 0.1F});
  CHECK(near(world.x_m, 0.9F));
  CHECK(near(world.y_m, 2.5F));
  const Point back = to_robot(robot, world);
  CHECK(near(back.x_m, 0.5F));
  CHECK(near(back.y_m, 0.1F));
}

}  // namespace motion_pose_test
