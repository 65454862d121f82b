/// Bit timing of bxCAN, the CAN controller of the STM32F1 and F4: a search for the register fields that give
/// a bit rate, and what a set of fields gives. constexpr, so that a board's timing is proved when it is
/// compiled.
///
/// A bit is tq * (1 + (TS1 + 1) + (TS2 + 1)) with tq = (BRP + 1) / PCLK1; the fields hold the values minus
/// one. [RM0008 24.7.7, RM0090 32.7.7]
#pragma once

#include <cstdint>

#include "ocm/base/result.hpp"

namespace ocm::can {

/// The fields of CAN_BTR as the register holds them.
struct BitTiming {
  std::uint16_t brp = 0;  ///< 0..1023
  std::uint8_t ts1 = 0;   ///< 0..15
  std::uint8_t ts2 = 0;   ///< 0..7
  std::uint8_t sjw = 0;   ///< 0..3

  [[nodiscard]] constexpr std::uint32_t quanta() const noexcept { return 1U + (ts1 + 1U) + (ts2 + 1U); }
  /// Bits per second, rounded down; exact when `exact(pclk_hz)`.
  [[nodiscard]] constexpr std::uint32_t bit_rate(std::uint32_t pclk_hz) const noexcept {
    return pclk_hz / ((brp + 1U) * quanta());
  }
  [[nodiscard]] constexpr bool exact(std::uint32_t pclk_hz) const noexcept {
    return pclk_hz % ((brp + 1U) * quanta()) == 0;
  }
  /// Where in the bit the level is read, in tenths of a per cent, rounded to nearest.
  [[nodiscard]] constexpr std::uint32_t sample_point_permille() const noexcept {
    return ((2U + ts1) * 1000U + quanta() / 2) / quanta();
  }
  [[nodiscard]] constexpr bool valid() const noexcept {
    return brp <= 1023 && ts1 <= 15 && ts2 <= 7 && sjw <= 3 && sjw <= ts2;
  }
  friend constexpr bool operator==(const BitTiming&, const BitTiming&) = default;
};

/// Fields that give exactly `bit_rate` from `pclk_hz` with the sample point nearest to
/// `sample_point_permille` (CiA recommends 875; AMiRo's boards sit lower). Among equals the one with most
/// quanta in a bit. Error::out_of_range when no fields give the rate exactly.
[[nodiscard]] constexpr base::Result<BitTiming> find_bit_timing(
    std::uint32_t pclk_hz, std::uint32_t bit_rate, std::uint32_t sample_point_permille = 875) noexcept {
  BitTiming best;
  std::uint32_t best_distance = UINT32_MAX;
  if (bit_rate == 0) return base::Error::out_of_range;
  for (std::uint32_t quanta = 25; quanta >= 4; --quanta) {  // most quanta first
    if (pclk_hz % (bit_rate * std::uint64_t{quanta}) != 0) continue;
    const std::uint64_t prescaler = pclk_hz / (bit_rate * std::uint64_t{quanta});
    if (prescaler < 1 || prescaler > 1024) continue;
    for (std::uint32_t segment2 = 1; segment2 <= 8; ++segment2) {
      if (segment2 + 2 > quanta || quanta - 1 - segment2 > 16) continue;
      BitTiming timing{static_cast<std::uint16_t>(prescaler - 1),
                       static_cast<std::uint8_t>(quanta - 2 - segment2),
                       static_cast<std::uint8_t>(segment2 - 1), 0};
      const std::uint32_t point = timing.sample_point_permille();
      const std::uint32_t distance =
          point > sample_point_permille ? point - sample_point_permille : sample_point_permille - point;
      if (distance < best_distance) {
        timing.sjw = timing.ts2 < 3 ? timing.ts2 : 3;
        best = timing;
        best_distance = distance;
      }
    }
  }
  if (best_distance == UINT32_MAX) return base::Error::out_of_range;
  return best;
}

}  // namespace ocm::can
