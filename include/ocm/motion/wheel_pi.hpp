/// A PI controller for each wheel, one following the other: motors that differ then turn alike. [T2 §7.1.1,
/// figure 7.2: the Arduino robot]
///
/// The master holds the rate that is asked for, the slave the rate that the master really makes, so that a
/// master under load slows both and the robot goes on straight. A motor needs more to start than to go on: a
/// wheel that should turn and does not gets at least the effort that starts it. Rates are magnitudes,
/// ticks/s; the direction is the motor's. Two PID steps each time; readings that are not finite are counted
/// there.
#pragma once

#include "ocm/motion/limits.hpp"
#include "ocm/motion/pid.hpp"
#include "ocm/motion/real.hpp"

namespace ocm::motion {

struct WheelPiModel {
  PidModel pi{.least = 0.0F, .most = 1.0F};  ///< output: effort
  float starting_effort = 0.0F;              ///< in [0, 1]
  bool right_is_master = true;
  /// How much faster the slave turns than the master: 1 for straight on and for turning on the spot.
  float slave_per_master = 1.0F;
};

struct WheelPi {
  Pid left{};
  Pid right{};
  friend bool operator==(const WheelPi&, const WheelPi&) = default;
};

struct WheelRates {
  float left_ticks_s = 0.0F;
  float right_ticks_s = 0.0F;
};

struct WheelPiStep {
  WheelPi state{};
  Efforts efforts{};
};

namespace detail {

constexpr float effort(const Pid& wheel, float wanted, float measured, const WheelPiModel& model) noexcept {
  const bool stuck = wanted > 0.0F && !(measured > 0.0F);
  return stuck && wheel.output < model.starting_effort ? model.starting_effort : wheel.output;
}

}  // namespace detail

/// `rate_ticks_s`: what the master should make, >= 0. At 0, or where it is not finite, both motors are off
/// and the integrals are gone.
[[nodiscard]] constexpr WheelPiStep control(WheelPi state, float rate_ticks_s, WheelRates measured,
                                            float dt_s, const WheelPiModel& model) noexcept {
  if (!is_finite(rate_ticks_s) || rate_ticks_s <= 0.0F) {
    const auto off = [](const Pid& wheel) { return Pid{.rejected = wheel.rejected}; };
    return {{off(state.left), off(state.right)}, {}};
  }
  const float master_ticks_s = model.right_is_master ? measured.right_ticks_s : measured.left_ticks_s;
  const float slave_wanted = model.slave_per_master * master_ticks_s;
  const float left_wanted = model.right_is_master ? slave_wanted : rate_ticks_s;
  const float right_wanted = model.right_is_master ? rate_ticks_s : slave_wanted;
  state.left = control(state.left, left_wanted, measured.left_ticks_s, dt_s, model.pi);
  state.right = control(state.right, right_wanted, measured.right_ticks_s, dt_s, model.pi);
  return {state,
          {detail::effort(state.left, left_wanted, measured.left_ticks_s, model),
           detail::effort(state.right, right_wanted, measured.right_ticks_s, model)}};
}

}  // namespace ocm::motion
