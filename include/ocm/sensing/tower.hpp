/// The sensor tower: four distance sensors at right angles on a servo of 90 degrees, so that together they
/// see all around. Where it looks next, and where in the world a reading lies. [T2 §5.3, §6.3, table 6.1]
///
///   parked, straight ahead   no operator confirmed the robot
///   small steps              it waits for a set point
///   holds                    it rotates, or is paused
///   larger steps             it drives
///
/// A step takes 200 ms: the servo has to settle, and the sentence to be sent [T2 §9.1]. Sweeping is integers
/// only and constexpr; a point costs two sines and two cosines.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "ocm/base/result.hpp"
#include "ocm/motion/pose.hpp"
#include "ocm/sensing/ir_sensor.hpp"
#include "ocm/sensing/servo.hpp"

namespace ocm::sensing {

/// In the order of their angles, to the left, where the servo is at 0.
enum class TowerSensor : std::uint8_t { forward, left, backward, right };

inline constexpr std::size_t tower_sensors = 4;

/// What the robot tells the operator of its tower at the handshake. [T2 table 4.4]
struct Tower {
  float ahead_of_axle_m = 0.0F;  ///< the servo's axis, negative: behind
  std::array<float, tower_sensors> sensor_heading_deg = {0.0F, 90.0F, 180.0F, 270.0F};
  std::array<float, tower_sensors> sensor_out_m = {};  ///< from the servo's axis to the sensor's face
};

/// Degrees a step. The thesis says small and larger, and no numbers.
struct SweepModel {
  std::int32_t waiting_deg = 2;
  std::int32_t driving_deg = 10;
};

enum class TowerMode : std::uint8_t { parked, waiting, holding, driving };

/// [T2 table 6.1]
[[nodiscard]] constexpr TowerMode tower_mode(bool confirmed, bool paused,
                                             motion::Movement movement) noexcept {
  if (!confirmed) return TowerMode::parked;
  if (paused || movement == motion::Movement::rotating) return TowerMode::holding;
  return movement == motion::Movement::straight ? TowerMode::driving : TowerMode::waiting;
}

struct Sweep {
  std::int32_t servo_deg = 0;
  bool upwards = true;
  friend bool operator==(const Sweep&, const Sweep&) = default;
};

/// Where the tower looks next: to and fro, both ends included.
[[nodiscard]] constexpr Sweep next(Sweep sweep, TowerMode mode, const SweepModel& model = {}) noexcept {
  if (mode == TowerMode::parked) return {};
  if (mode == TowerMode::holding) return sweep;
  const std::int32_t step = mode == TowerMode::driving ? model.driving_deg : model.waiting_deg;
  sweep.servo_deg = within_servo(sweep.upwards ? sweep.servo_deg + step : sweep.servo_deg - step);
  if (sweep.servo_deg == servo_most_deg) sweep.upwards = false;
  if (sweep.servo_deg == servo_least_deg) sweep.upwards = true;
  return sweep;
}

/// Where a sensor looks, as seen by the robot: left of straight ahead is positive, in (-pi, pi].
[[nodiscard]] constexpr float bearing_rad(const Tower& tower, std::int32_t servo_deg,
                                          TowerSensor sensor) noexcept {
  return motion::wrap(motion::radians(tower.sensor_heading_deg[static_cast<std::size_t>(sensor)] +
                                      static_cast<float>(within_servo(servo_deg))));
}

/// The point in the world that a reading is from. Nothing seen, or a pose that is not finite:
/// Error::not_sampled.
[[nodiscard]] inline base::Result<motion::Point> seen_at(const motion::Pose& robot, const Tower& tower,
                                                         std::int32_t servo_deg, TowerSensor sensor,
                                                         IrReading reading) noexcept {
  if (reading.range == IrRange::nothing || !motion::is_finite(robot)) return base::Error::not_sampled;
  const float bearing = bearing_rad(tower, servo_deg, sensor);
  const float reach_m = tower.sensor_out_m[static_cast<std::size_t>(sensor)] + reading.distance_cm / 100.0F;
  return motion::to_world(robot,
                          {tower.ahead_of_axle_m + reach_m * std::cos(bearing), reach_m * std::sin(bearing)});
}

}  // namespace ocm::sensing
