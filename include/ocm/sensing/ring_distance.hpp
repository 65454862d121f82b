/// How far away something is that a VCNL4020 of the AMiRo's proximity ring sees, from its counts.
///
/// counts above the offset = 0.9427 / d^2 * |cos(1.2365 * angle)|, d in metres, measured on the AMiRo itself,
/// with a standard deviation of 4.57 counts [obstacle model in VCNL4020Models.h of
/// github.com/tik0/amiro_senseact]. Here it is solved for the distance, head on: what is at an angle, or
/// dark, seems further away than it is. Between two sensors of the ring, 22.5 degrees off both, that is 7 %.
///
/// Integers only, constant time: a division and 16 steps of a square root.
#pragma once

#include <array>
#include <cstdint>

namespace ocm::sensing {

/// The law's constant, mm^2 * counts.
inline constexpr std::uint32_t counts_mm2 = 942'694;
/// The greatest range of the part. [VCNL4020 data sheet] Beyond it the counts are noise.
inline constexpr std::uint16_t ring_range_mm = 200;
/// Counts above the offset at that range: five standard deviations.
inline constexpr std::uint16_t least_ring_counts = 24;

/// Distances of the eight sensors, mm, at most `ring_range_mm`. The first looks back left, 157.5 degrees, the
/// others follow clockwise, 45 degrees apart. [AMiRo-OS 1.0, Constants.h: SENSOR_ANGULAR_POS_FIRST]
using RingDistances = std::array<std::uint16_t, 8>;

/// Rounded down.
[[nodiscard]] constexpr std::uint16_t square_root(std::uint32_t square) noexcept {
  std::uint32_t root = 0;
  for (std::uint32_t bit = 0x8000; bit != 0; bit >>= 1U)
    if (const std::uint32_t more = root | bit; more * more <= square) root = more;
  return static_cast<std::uint16_t>(root);
}

/// Distance from the sensor, mm, rounded down: 3 to `ring_range_mm`, which also says that nothing is in
/// sight.
[[nodiscard]] constexpr std::uint16_t ring_distance_mm(std::uint16_t counts, std::uint16_t offset) noexcept {
  const auto above = static_cast<std::uint16_t>(counts > offset ? counts - offset : 0);
  if (above < least_ring_counts) return ring_range_mm;
  const std::uint16_t distance = square_root(counts_mm2 / above);
  return distance < ring_range_mm ? distance : ring_range_mm;
}

}  // namespace ocm::sensing
