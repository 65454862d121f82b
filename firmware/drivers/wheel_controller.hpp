/// Velocity controller of one wheel: feed-forward, proportional and integral, with an integral that does not
/// wind up.
///
/// Whole numbers, because a Cortex-M3 has no floating point: some 30 instructions a step where double would
/// cost some 600, and the same bits on every board and host. Speeds are in 1/256 tick a step. The integral is
/// the sum of what was asked for less the ticks that came, so it is the error of the way: rounding ticks to
/// whole ones adds up to nothing, and the wheel arrives where the set points say.
#pragma once

#include <algorithm>
#include <cstdint>

#include "firmware/drivers/bus.hpp"

namespace ocm::firmware::drivers {

/// Duty for a speed or for an error of a way, of which `full_duty` is all.
struct WheelGains {
  /// Duty a speed of 1, in 1/65536: what the motor needs by itself.
  std::int32_t forward = 0;
  std::int32_t proportional = 0;  ///< the same, of the error in speed
  std::int32_t integral = 0;      ///< the same, of the error of the way

  /// @param full_speed the speed at full duty, in 1/256 tick a step
  [[nodiscard]] static constexpr WheelGains for_full_speed(std::int32_t full_speed) noexcept {
    const auto one = static_cast<std::int32_t>(std::int64_t{full_duty} * 65536 / full_speed);
    // A wheel whose speed lags by 5 steps then has its poles at 0.80 and 0.91 a step: no overshoot of
    // its own, an error is a tenth after 25 steps. [decided]
    return {one, one / 2, one / 10};
  }
};

class WheelController {
 public:
  explicit constexpr WheelController(const WheelGains& gains) noexcept : gains_(gains) {}

  /// One step. @param speed set point, in 1/256 tick a step @param moved ticks since the last step
  /// @return duty, -full_duty to full_duty
  [[nodiscard]] constexpr std::int16_t step(std::int16_t speed, std::int16_t moved) noexcept {
    const std::int32_t error = speed - std::int32_t{moved} * 256;
    if (speed == 0) {  // stop, and stay where that is: the way that is still missing is not made up
      way_ = 0;
      // A tick more or less is where the wheel rests on an edge: no reason to push. Without voltage it
      // brakes.
      return moved >= -1 && moved <= 1 ? std::int16_t{0} : limit(std::int64_t{gains_.proportional} * error);
    }
    const std::int64_t wanted = std::int64_t{gains_.forward} * speed +
                                std::int64_t{gains_.proportional} * error +
                                std::int64_t{gains_.integral} * (std::int64_t{way_} + error);
    // At full duty the way that is missing grows only if that brings the duty back: else it would have to be
    // made up later, by going too fast.
    const bool pushes_on = (wanted > most && error > 0) || (wanted < -most && error < 0);
    if (!pushes_on) way_ = std::clamp(way_ + error, -longest_way, longest_way);
    return limit(wanted);
  }

  constexpr void reset() noexcept { way_ = 0; }
  /// What is missing of the way, in 1/256 tick.
  [[nodiscard]] constexpr std::int32_t way() const noexcept { return way_; }

 private:
  static constexpr std::int64_t most = std::int64_t{full_duty} * 65536;
  static constexpr std::int32_t longest_way = 1'000'000'000;

  [[nodiscard]] static constexpr std::int16_t limit(std::int64_t duty) noexcept {
    return static_cast<std::int16_t>(std::clamp<std::int64_t>(duty / 65536, -full_duty, full_duty));
  }

  WheelGains gains_;
  std::int32_t way_ = 0;
};

}  // namespace ocm::firmware::drivers
