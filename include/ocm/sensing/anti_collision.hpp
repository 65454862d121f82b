/// Stops the robot in front of things, from readings that are there anyway. [T2 §8.5, listing 8.2]
///
/// Integers only, constant time: up to 30 degrees of servo the forward sensor looks ahead, from 60 the right
/// one, and between them none does. The distance is not projected by a cosine, so the boundary is an arc
/// around the tower. 0 means nothing seen.
#pragma once

#include <cstdint>

namespace ocm::sensing {

/// What the tower has ahead of the robot, cm; 0: nothing, or no sensor looks there.
[[nodiscard]] constexpr std::int32_t ahead_cm(std::int32_t servo_deg, std::int32_t forward_cm,
                                              std::int32_t right_cm) noexcept {
  if (servo_deg <= 30) return forward_cm;
  return servo_deg >= 60 ? right_cm : 0;
}

/// Whether to stop, and then to report idle.
[[nodiscard]] constexpr bool must_stop(std::int32_t servo_deg, std::int32_t forward_cm, std::int32_t right_cm,
                                       std::int32_t minimum_cm) noexcept {
  const std::int32_t object_cm = ahead_cm(servo_deg, forward_cm, right_cm);
  return 0 < object_cm && object_cm < minimum_cm;
}

}  // namespace ocm::sensing
