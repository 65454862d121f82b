/// A mapper's tower: where it looks, what that is as a sentence, and whether something is in the way.
/// [T2 §6.3, table 6.1, §8.5]
///
/// Integers but for the four curves of the sensors; O(1), 8 bytes, no heap, no clock.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "ocm/base/result.hpp"
#include "ocm/mapper/link/sentence.hpp"
#include "ocm/motion/angle.hpp"
#include "ocm/motion/pose.hpp"
#include "ocm/motion/real.hpp"
#include "ocm/sensing/anti_collision.hpp"
#include "ocm/sensing/ir_sensor.hpp"
#include "ocm/sensing/tower.hpp"

namespace ocm::mapper::app {

/// Whole centimetres by sensing::TowerSensor; 0: nothing seen, or no answer.
using Distances = std::array<std::int16_t, sensing::tower_sensors>;

[[nodiscard]] constexpr std::int16_t distance_cm(base::Result<float> volts,
                                                 const sensing::IrCurve& curve) noexcept {
  if (!volts) return 0;
  return static_cast<std::int16_t>(sensing::ir_distance(*volts, curve).distance_cm + 0.5F);
}

/// Centimetres and degrees, to the nearest; Error::out_of_range: a place that 16 bits do not hold, 327 m
/// away.
[[nodiscard]] inline base::Result<link::Update> update(const motion::Pose& pose, std::int32_t servo_deg,
                                                       const Distances& seen) noexcept {
  constexpr float most_m = 327.0F;
  const bool within = motion::magnitude(pose.x_m) <= most_m && motion::magnitude(pose.y_m) <= most_m;
  if (!within || !motion::is_finite(pose.heading_rad)) return base::Error::out_of_range;
  const auto whole = [](float value) { return static_cast<std::int16_t>(std::lround(value)); };
  return link::Update{.x = whole(pose.x_m * 100.0F),
                      .y = whole(pose.y_m * 100.0F),
                      .heading = whole(motion::degrees(motion::wrap(pose.heading_rad))),
                      .servo = static_cast<std::int16_t>(servo_deg),
                      .s1 = seen[0],
                      .s2 = seen[1],
                      .s3 = seen[2],
                      .s4 = seen[3]};
}

/// Listing 8.2 where the robot drives ahead; the same with the two sensors that look behind where it drives
/// back, which the listing leaves out. Who stands or rotates hits nothing.
[[nodiscard]] constexpr bool in_the_way(motion::Movement movement, bool backwards, std::int32_t servo_deg,
                                        const Distances& seen, std::int32_t minimum_cm) noexcept {
  if (movement != motion::Movement::straight) return false;
  using sensing::TowerSensor;
  const auto of = [&seen](TowerSensor sensor) { return seen[static_cast<std::size_t>(sensor)]; };
  return backwards
             ? sensing::must_stop(servo_deg, of(TowerSensor::backward), of(TowerSensor::left), minimum_cm)
             : sensing::must_stop(servo_deg, of(TowerSensor::forward), of(TowerSensor::right), minimum_cm);
}

}  // namespace ocm::mapper::app
