#include "ocm/motion/pose.hpp"

#include <catch2/catch.hpp>

#include "unit/motion/near.hpp"

namespace motion_pose_test {

using namespace ocm::motion;
using ocm::test::near;

constexpr Drive drive{.wheel_radius_m = 0.05F, .wheelbase_m = 0.2F, .ticks_per_turn = 198.0F};
static_assert(drive.valid() && !Drive{}.valid());
static_assert(near(drive.m_per_tick(), 0.00158666F, 1e-7F));  // 2 pi 50 mm / 198

// By hand, eq. 2.3: v = 0.025 (4 + 2) = 0.15 m/s, w = 0.25 (4 - 2) = 0.5 rad/s.
static_assert(near(twist({2.0F, 4.0F}, drive).speed_m_s, 0.15F));
static_assert(near(twist({2.0F, 4.0F}, drive).turn_rad_s, 0.5F));
static_assert(near(wheel_speeds({0.15F, 0.5F}, drive).left_rad_s, 2.0F));
static_assert(near(wheel_speeds({0.15F, 0.5F}, drive).right_rad_s, 4.0F));

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
