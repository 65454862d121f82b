/// Converts between time and whole bits of a bus, without drift at any bit rate: also where a bit is no whole
/// number of nanoseconds, as at 666'667 bit/s. constexpr, no heap, two divisions a call.
#pragma once

#include <cassert>
#include <cstdint>

#include "ocm/base/time.hpp"

namespace ocm::simulation {

/// Bits since an epoch. Boundary k lies at exactly k / rate seconds; its time stamp is rounded down to the
/// nanosecond. Up to 1 Gbit/s the two directions are inverse: `boundary_from(time_of(k)) == k`.
class BitClock {
 public:
  static constexpr std::uint32_t max_bit_rate = 1'000'000'000;

  /// `bit_rate`: 1 to 1'000'000'000 bit/s.
  constexpr explicit BitClock(std::uint32_t bit_rate, base::Time epoch = {}) noexcept
      : epoch_ns_(epoch.time_since_epoch().count()), bit_rate_(bit_rate) {
    assert(bit_rate >= 1 && bit_rate <= max_bit_rate);
  }

  [[nodiscard]] constexpr std::uint32_t bit_rate() const noexcept {
    return static_cast<std::uint32_t>(bit_rate_);
  }

  /// The first boundary at or after `time`; 0 before the epoch.
  [[nodiscard]] constexpr std::uint64_t boundary_from(base::Time time) const noexcept {
    const std::int64_t time_ns = time.time_since_epoch().count();
    if (time_ns <= epoch_ns_) return 0;
    // Unsigned: the difference of two signed 64-bit times needs all 64 bits, and so do the bits of 584 years.
    const std::uint64_t elapsed = static_cast<std::uint64_t>(time_ns) - static_cast<std::uint64_t>(epoch_ns_);
    const std::uint64_t seconds = elapsed / second_ns;
    const std::uint64_t rest = elapsed % second_ns * bit_rate_;  // below 10^18
    return seconds * bit_rate_ + rest / second_ns + (rest % second_ns != 0 ? 1 : 0);
  }

  /// base::never for a boundary that no time stamp can express.
  [[nodiscard]] constexpr base::Time time_of(std::uint64_t boundary) const noexcept {
    const std::uint64_t rest_ns = boundary % bit_rate_ * second_ns / bit_rate_;
    std::uint64_t elapsed = 0;
    std::int64_t time_ns = 0;
    if (__builtin_mul_overflow(boundary / bit_rate_, second_ns, &elapsed) ||
        __builtin_add_overflow(elapsed, rest_ns, &elapsed) ||
        __builtin_add_overflow(epoch_ns_, elapsed, &time_ns))
      return base::never;
    return base::Time{base::Duration{time_ns}};
  }

 private:
  static constexpr std::uint64_t second_ns = 1'000'000'000;

  std::int64_t epoch_ns_;
  std::uint64_t bit_rate_;
};

}  // namespace ocm::simulation
