/// Where a robot is and how it moves: pose, twist, wheel speeds, and the frame of the robot in the world.
/// x points ahead at heading 0, y to the left, headings grow to the left, in (-pi, pi]. Lengths are metres.
/// Plain values; the only cost is sin and cos where a frame is turned.
#pragma once

#include <cmath>

#include "ocm/motion/angle.hpp"
#include "ocm/motion/real.hpp"

namespace ocm::motion {

struct Point {
  float x_m = 0.0F;
  float y_m = 0.0F;
  friend bool operator==(const Point&, const Point&) = default;
};

struct Pose {
  float x_m = 0.0F;
  float y_m = 0.0F;
  float heading_rad = 0.0F;
  friend bool operator==(const Pose&, const Pose&) = default;
};

/// Of the middle of the axle.
struct Twist {
  float speed_m_s = 0.0F;
  float turn_rad_s = 0.0F;  ///< left is positive
  friend bool operator==(const Twist&, const Twist&) = default;
};

struct WheelSpeeds {
  float left_rad_s = 0.0F;
  float right_rad_s = 0.0F;
  friend bool operator==(const WheelSpeeds&, const WheelSpeeds&) = default;
};

/// A robot on two driven wheels. Both depend on the floor a little: to be calibrated. [T2 §7.3]
struct Drive {
  float wheel_radius_m = 0.0F;
  float wheelbase_m = 0.0F;  ///< between the points where the wheels touch the floor
  float ticks_per_turn = 0.0F;

  [[nodiscard]] constexpr bool valid() const noexcept {
    return all_finite(wheel_radius_m, wheelbase_m, ticks_per_turn) && wheel_radius_m > 0.0F &&
           wheelbase_m > 0.0F && ticks_per_turn > 0.0F;
  }
  /// What one tick of the encoder is on the floor. [T2 eq. 2.5]
  [[nodiscard]] constexpr float m_per_tick() const noexcept {
    return two_pi * wheel_radius_m / ticks_per_turn;
  }
};

/// What the robot is doing; the estimator trusts its parts accordingly, and the tower turns accordingly.
enum class Movement : unsigned char { standing, straight, rotating };

[[nodiscard]] constexpr bool is_finite(const Pose& pose) noexcept {
  return all_finite(pose.x_m, pose.y_m, pose.heading_rad);
}

/// v = R/2 (w_r + w_l), w = R/L (w_r - w_l). [T2 eq. 2.2, 2.3]
[[nodiscard]] constexpr Twist twist(WheelSpeeds wheels, const Drive& drive) noexcept {
  return {drive.wheel_radius_m / 2.0F * (wheels.right_rad_s + wheels.left_rad_s),
          drive.wheel_radius_m / drive.wheelbase_m * (wheels.right_rad_s - wheels.left_rad_s)};
}

/// w_r = (2v + wL)/2R, w_l = (2v - wL)/2R. [T2 eq. 2.3]
[[nodiscard]] constexpr WheelSpeeds wheel_speeds(Twist twist, const Drive& drive) noexcept {
  const float ahead = 2.0F * twist.speed_m_s;
  const float turn = twist.turn_rad_s * drive.wheelbase_m;
  const float diameter = 2.0F * drive.wheel_radius_m;
  return {(ahead - turn) / diameter, (ahead + turn) / diameter};
}

/// From a point as the robot sees it to where it is in the world.
[[nodiscard]] inline Point to_world(const Pose& robot, Point seen) noexcept {
  const float c = std::cos(robot.heading_rad);
  const float s = std::sin(robot.heading_rad);
  return {robot.x_m + c * seen.x_m - s * seen.y_m, robot.y_m + s * seen.x_m + c * seen.y_m};
}

/// From a point in the world to how the robot sees it.
[[nodiscard]] inline Point to_robot(const Pose& robot, Point world) noexcept {
  const float c = std::cos(robot.heading_rad);
  const float s = std::sin(robot.heading_rad);
  const float x = world.x_m - robot.x_m;
  const float y = world.y_m - robot.y_m;
  return {c * x + s * y, c * y - s * x};
}

}  // namespace ocm::motion
