/// A servo from 0 to 90 degrees, in whole degrees and in counts of the timer that makes its pulses: integers
/// only. Calibrated by the counts at both ends; the thesis' 16-bit timers have 1150 steps in between. [T2
/// §10.2.3] constexpr, constant time; angles outside are taken for the nearest end.
#pragma once

#include <cstdint>

namespace ocm::sensing {

inline constexpr std::int32_t servo_least_deg = 0;
inline constexpr std::int32_t servo_most_deg = 90;

[[nodiscard]] constexpr std::int32_t within_servo(std::int32_t degrees) noexcept {
  return degrees < servo_least_deg ? servo_least_deg : degrees > servo_most_deg ? servo_most_deg : degrees;
}

struct ServoCalibration {
  std::uint16_t count_at_0_deg = 0;
  std::uint16_t count_at_90_deg = 0;  ///< may be the smaller: a servo mounted the other way round
};

/// Timer counts of the pulse, rounded to the nearest.
[[nodiscard]] constexpr std::uint16_t servo_count(std::int32_t degrees, ServoCalibration servo) noexcept {
  const std::int32_t span = std::int32_t{servo.count_at_90_deg} - servo.count_at_0_deg;
  const std::int32_t half = span < 0 ? -servo_most_deg / 2 : servo_most_deg / 2;
  return static_cast<std::uint16_t>(servo.count_at_0_deg +
                                    (within_servo(degrees) * span + half) / servo_most_deg);
}

}  // namespace ocm::sensing
