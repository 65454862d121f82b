/// Dead reckoning: from ticks of two wheel encoders to a pose, by the mid-point rule. [T2 eq. 2.4 to 2.6]
///
///   d = (dl + dr)/2, dth = (dr - dl)/L
///   x += d cos(th + dth/2), y += d sin(th + dth/2), th += dth
///
/// On an arc the chord points exactly along th + dth/2, and is shorter than d by the factor
/// sin(dth/2)/(dth/2): 1e-4 at a step of 2.8 degrees. Cost: one sin and one cos a step.
/// Counters may wrap around 32 bits. A step of more ticks than the wheel can make (a counter that was reset)
/// moves nothing, is counted, and the next step starts from the new count.
#pragma once

#include <cmath>
#include <cstdint>

#include "ocm/motion/angle.hpp"
#include "ocm/motion/pose.hpp"
#include "ocm/motion/real.hpp"

namespace ocm::motion {

/// Ticks from one count to a later one, across the wrap of 32 bits; right for up to 2^31 - 1 of them.
[[nodiscard]] constexpr std::int32_t ticks_between(std::uint32_t before, std::uint32_t now) noexcept {
  return static_cast<std::int32_t>(now - before);
}

/// Counts an encoder of one channel, which cannot see which way the wheel turns: the motor's command says it.
/// No command, no count; and a stop keeps the last direction, because the wheel rolls on. [T2 §6.4.1]
class DirectedTicks {
 public:
  enum class Direction : signed char { backward = -1, unknown = 0, forward = 1 };

  constexpr void command(Direction direction) noexcept {
    if (direction != Direction::unknown) direction_ = direction;
  }
  constexpr void pulses(std::uint32_t n) noexcept {
    if (direction_ == Direction::unknown) {
      undirected_ += n;
    } else {
      count_ += direction_ == Direction::forward ? n : 0U - n;
    }
  }
  [[nodiscard]] constexpr std::uint32_t count() const noexcept { return count_; }
  /// Pulses before the first command: their direction is not known.
  [[nodiscard]] constexpr std::uint32_t undirected() const noexcept { return undirected_; }

 private:
  std::uint32_t count_ = 0;
  std::uint32_t undirected_ = 0;
  Direction direction_ = Direction::unknown;
};

/// What the robot did in one step.
struct Advance {
  float distance_m = 0.0F;
  float turn_rad = 0.0F;
  friend bool operator==(const Advance&, const Advance&) = default;
};

/// [T2 eq. 2.5, 2.6] Ticks are subtracted before they are scaled: a processor that multiplies and adds in one
/// rounding would make a small turn of equal ticks.
[[nodiscard]] constexpr Advance advance(std::int32_t left_ticks, std::int32_t right_ticks,
                                        const Drive& drive) noexcept {
  const auto left = static_cast<float>(left_ticks);
  const auto right = static_cast<float>(right_ticks);
  return {(left + right) * drive.m_per_tick() / 2.0F,
          (right - left) * drive.m_per_tick() / drive.wheelbase_m};
}

/// The pose after an advance; where that is not finite, the pose as it was. [T2 eq. 2.4]
[[nodiscard]] inline Pose moved(const Pose& from, Advance by) noexcept {
  const float along = from.heading_rad + by.turn_rad / 2.0F;
  const Pose to{from.x_m + by.distance_m * std::cos(along), from.y_m + by.distance_m * std::sin(along),
                wrap(from.heading_rad + by.turn_rad)};
  return is_finite(to) ? to : from;
}

/// Two counts that become an advance a step.
struct WheelCounts {
  std::uint32_t left = 0;
  std::uint32_t right = 0;
  std::uint32_t rejected = 0;  ///< steps of more ticks than possible
  bool started = false;        ///< the first counts are where it starts: no advance
  friend bool operator==(const WheelCounts&, const WheelCounts&) = default;
};

struct CountedAdvance {
  WheelCounts counts{};
  Advance advance{};
};

/// `most_ticks`: what a wheel can make in one step, with some room; the AVR robot's makes 66/s, the Arduino
/// robot's 1250/s. [T2 §11.2.3]
[[nodiscard]] constexpr CountedAdvance count(WheelCounts counts, std::uint32_t left, std::uint32_t right,
                                             std::int32_t most_ticks, const Drive& drive) noexcept {
  const std::int32_t dl = ticks_between(counts.left, left);
  const std::int32_t dr = ticks_between(counts.right, right);
  const bool started = counts.started;
  counts.left = left;
  counts.right = right;
  counts.started = true;
  if (!started) return {counts, {}};
  const auto possible = [most_ticks](std::int32_t ticks) {
    return ticks <= most_ticks && ticks >= -most_ticks;
  };
  if (!possible(dl) || !possible(dr)) {
    ++counts.rejected;
    return {counts, {}};
  }
  return {counts, advance(dl, dr, drive)};
}

}  // namespace ocm::motion
