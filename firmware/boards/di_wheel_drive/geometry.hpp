/// The robot's wheels in numbers, and how its two velocities become those of the wheels.
#pragma once

#include <algorithm>
#include <numbers>

#include "ocm/topics/amiro.hpp"

#include "firmware/boards/samples.hpp"

namespace ocm::firmware::boards::di_wheel_drive {

inline constexpr double wheel_diameter_m = 0.05571;  ///< [AMiRo-OS 1.0, Constants.h: wheelDiameterSI]
inline constexpr double wheel_base_m = 0.069;        ///< [AMiRo-OS 1.0, Constants.h: wheelBaseDistanceSI]

/// 16 pulses on each of 2 channels, both edges, gearbox 22:1. [AMiRo-OS 1.0, Constants.h]
inline constexpr int ticks_per_turn = 2 * 2 * 16 * 22;

/// 0.1243 mm.
inline constexpr double metres_per_tick = std::numbers::pi * wheel_diameter_m / ticks_per_turn;

/// The set point of both greatest velocities that the spec gives the motors.
inline constexpr amiro::Motors greatest_set_point = [] {
  constexpr double beyond = 1e6;  // of any robot; setters stay within the range
  amiro::Motors motors;
  motors.set_x_m_per_s(beyond);
  motors.set_z_rad_per_s(beyond);
  return motors;
}();

/// Fastest that a wheel is asked to go: straight ahead at the greatest velocity.
inline constexpr double greatest_wheel_speed_m_per_s = greatest_set_point.x_m_per_s();

/// Wheel speeds for a forward velocity (m/s) and an angular velocity (rad/s, counter-clockwise positive).
/// When a wheel would be too fast both are scaled: the robot takes the same path more slowly.
[[nodiscard]] constexpr WheelSpeeds wheel_speeds(double forward_m_per_s, double turn_rad_per_s) noexcept {
  const double half_difference = turn_rad_per_s * wheel_base_m / 2;
  const double left = forward_m_per_s - half_difference;
  const double right = forward_m_per_s + half_difference;
  const double fastest = std::max({left, -left, right, -right});
  const double scale = fastest > greatest_wheel_speed_m_per_s ? greatest_wheel_speed_m_per_s / fastest : 1.0;
  return {left * scale, right * scale};
}

// On the spot the wheels are as fast, to the microradian a second.
static_assert(greatest_set_point.z_rad_per_s() * wheel_base_m / 2 <= greatest_wheel_speed_m_per_s);
static_assert((greatest_set_point.z_rad_per_s() + 2e-6) * wheel_base_m / 2 > greatest_wheel_speed_m_per_s);

static_assert(wheel_speeds(0.1, 0) == WheelSpeeds{0.1, 0.1});
static_assert(wheel_speeds(0, 2) == WheelSpeeds{-0.069, 0.069});
static_assert(wheel_speeds(2, 0) == WheelSpeeds{1, 1});
static_assert(wheel_speeds(-4, 0) == WheelSpeeds{-1, -1});

}  // namespace ocm::firmware::boards::di_wheel_drive
