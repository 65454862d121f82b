/// Noise that depends on nothing but the seed, the part and the number of the sample: no generator is
/// advanced, so it does not matter who else reads what, how often and in which order.
///
/// A counter-based generator in the sense of Salmon et al., "Parallel random numbers: as easy as 1, 2, 3",
/// SC 2011; the mixing function is that of SplitMix64 (Steele, Lea, Flood, "Fast splittable pseudorandom
/// number generators", OOPSLA 2014). Integers up to the last division, so that every compiler and standard
/// library gives the same bits. A normal number costs about 10 ns.
#pragma once

#include <cstdint>

namespace ocm::sim {

/// The `n`th output (from 0) of SplitMix64 with this seed.
[[nodiscard]] constexpr std::uint64_t split_mix(std::uint64_t seed, std::uint64_t n) noexcept {
  std::uint64_t z = seed + (n + 1) * 0x9E3779B97F4A7C15;
  z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9;
  z = (z ^ z >> 27) * 0x94D049BB133111EB;
  return z ^ z >> 31;
}
// [Rosetta Code, "Pseudo-random numbers/Splitmix64"]
static_assert(split_mix(1234567, 0) == 6457827717110365317U);
static_assert(split_mix(1234567, 4) == 16408922859458223821U);

/// One stream of noise: one part of one world.
class Noise {
 public:
  constexpr Noise(std::uint64_t seed, std::uint64_t part) noexcept
      : key_(split_mix(split_mix(seed, 0), part)) {}

  /// Mean 0, variance 1, never beyond 6: the sum of twelve uniform numbers less 6, which is normal enough for
  /// a sensor and needs no logarithm.
  /// @param channel 0..255: which of the part's axes or sensors
  [[nodiscard]] constexpr double normal(std::uint64_t sample, std::uint8_t channel) const noexcept {
    const std::uint64_t first = (sample << 8 | channel) * 6;
    std::uint64_t sum = 0;
    for (unsigned i = 0; i < 6; ++i) {
      const std::uint64_t bits = split_mix(key_, first + i);
      sum += (bits & 0xFFFFFFFF) + (bits >> 32);
    }
    return static_cast<double>(sum) / 4294967296.0 - 6.0;
  }
  /// Drawn once for the part: bias, offset.
  [[nodiscard]] constexpr double constant(std::uint8_t channel) const noexcept {
    return normal(~std::uint64_t{0} >> 16, channel);
  }

 private:
  std::uint64_t key_;
};

}  // namespace ocm::sim
