/// Keeps motors that know only on and off at the same pace: the wheel that is ahead waits. [T2 eq. 7.1]
///
///   e2 = right - left ticks,  u2 = 1 where |e2| < 1, else 0 for the faster wheel
///
/// Integers only, constant time. A wheel that is stuck stops both, which is meant.
#pragma once

#include <cstdint>

#include "ocm/motion/odometry.hpp"

namespace ocm::motion {

struct WheelGate {
  bool left = true;
  bool right = true;
  friend bool operator==(const WheelGate&, const WheelGate&) = default;
};

/// Ticks since the movement began, in the direction in which each wheel was commanded: so rotating on the
/// spot is gated, too.
[[nodiscard]] constexpr WheelGate gate(std::int32_t left_ticks, std::int32_t right_ticks) noexcept {
  return {left_ticks <= right_ticks, right_ticks <= left_ticks};
}

/// The same of wrapping counters: where they were when the movement began, and the direction of each.
[[nodiscard]] constexpr WheelGate gate(std::uint32_t left_start, std::uint32_t left_now, bool left_forward,
                                       std::uint32_t right_start, std::uint32_t right_now,
                                       bool right_forward) noexcept {
  const auto done = [](std::uint32_t start, std::uint32_t now, bool forward) {
    return forward ? ticks_between(start, now) : ticks_between(now, start);
  };
  return gate(done(left_start, left_now, left_forward), done(right_start, right_now, right_forward));
}

}  // namespace ocm::motion
