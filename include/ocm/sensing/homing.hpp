/// Brings a round robot up to the nearest wall, head on, by the distances that a ring of eight sensors around
/// it sees, and keeps it there at a stated distance: where it charges, or begins its next way from.
///
/// While nothing is in sight it drives straight on. What is in sight pulls it, the more the nearer, as the
/// light that comes back does, with 1/d^2; the robot turns on the spot until the pull is ahead, then drives
/// at gain * (distance - what is kept), backwards where it is too near. It has arrived when both are within
/// bounds, and rests until one is well beyond, for a while: the noise of the sensors moves no wheel.
///
/// The sensors of a ring look past a wall that is ahead: each side of it by 22.5 degrees, from a place behind
/// the foremost of the robot. `seen_part` and `behind_m` are what a flat wall makes of that.
///
/// Pure steps, constant time: some fifty float operations, no library call. constexpr.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "ocm/motion/limits.hpp"
#include "ocm/motion/pose.hpp"
#include "ocm/motion/real.hpp"
#include "ocm/sensing/ring_distance.hpp"

namespace ocm::sensing {

struct HomingModel {
  float gain_per_s = 1.0F;  ///< speed for what is too far; below that of AvoidanceModel, for the same delays
  float turn_gain_per_s = 2.0F;    ///< turn for the sine of where the pull comes from,
  float most_turn_rad_s = 1.5F;    ///< at most
  float ahead_sine = 0.35F;        ///< less off, 20 degrees, counts as ahead: then it drives, too
  float seen_part = 1.05F;         ///< what a sensor says of a wall that is ahead, for 1 m from its own place
  float behind_m = 0.0038F;        ///< so much farther than from the robot's foremost place
  float arrived_m = 0.004F;        ///< within this of what is kept,
  float arrived_sine = 0.09F;      ///< and 5 degrees
  float gone_m = 0.015F;           ///< and arrived no longer beyond this,
  float gone_sine = 0.26F;         ///< and 15 degrees
  float gone_s = 0.5F;             ///< for so long in a row
  float acceleration_m_s2 = 0.5F;  ///< it gets faster no sooner; slower at once
};

struct Homing {
  float speed_m_s = 0.0F;
  float beyond_s = 0.0F;  ///< so long it has been beyond the wider bounds, having arrived
  bool arrived = false;
  std::uint32_t rejected = 0;  ///< steps without a finite speed or without time: standing for that step
};

struct HomingStep {
  Homing state{};
  motion::Twist command{};
};

/// The longest that anything may take from the sensors to the wheels' speed.
[[nodiscard]] constexpr float most_delay_s(const HomingModel& model) noexcept {
  return motion::most_dead_time_s(model.gain_per_s > model.turn_gain_per_s ? model.gain_per_s
                                                                           : model.turn_gain_per_s);
}

namespace detail {
struct Direction {
  float ahead;
  float left;
};
/// Of the sensors, in the order of RingDistances: 22.5 degrees more than a multiple of 45.
inline constexpr float near_axis = 0.92387953F;
inline constexpr float far_axis = 0.38268343F;
inline constexpr std::array<Direction, 8> ring_directions{{{-near_axis, far_axis},
                                                           {-far_axis, near_axis},
                                                           {far_axis, near_axis},
                                                           {near_axis, far_axis},
                                                           {near_axis, -far_axis},
                                                           {far_axis, -near_axis},
                                                           {-far_axis, -near_axis},
                                                           {-near_axis, -far_axis}}};
}  // namespace detail

/// One step at a speed of at most `most_m_s` (zero or more) towards `keep_m` before the nearest wall, `dt_s`
/// after the last one.
[[nodiscard]] constexpr HomingStep home(Homing state, const RingDistances& ring, float keep_m, float most_m_s,
                                        float dt_s, const HomingModel& model) noexcept {
  if (!motion::is_finite(most_m_s) || most_m_s < 0.0F || !motion::is_finite(keep_m) ||
      !motion::is_step(dt_s)) {
    ++state.rejected;
    state.speed_m_s = 0.0F;
    return {state, {}};
  }
  float ahead = 0.0F;
  float left = 0.0F;
  float nearest_m = static_cast<float>(ring_range_mm) / 1000.0F;
  bool seen = false;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    if (ring[i] >= ring_range_mm || ring[i] == 0) continue;
    seen = true;
    const float d_m = static_cast<float>(ring[i]) / 1000.0F;
    if (d_m < nearest_m) nearest_m = d_m;
    const float pull = 1.0F / (d_m * d_m);
    ahead += pull * detail::ring_directions[i].ahead;
    left += pull * detail::ring_directions[i].left;
  }
  const auto drive = [&](float wanted_m_s, float turn_rad_s) {
    // Slower at once, at most to rest: the other way it gets faster from there.
    const bool turns_round = wanted_m_s * state.speed_m_s < 0.0F;
    const float from_m_s = turns_round ? 0.0F : state.speed_m_s;
    const float faster_m_s = motion::limited(from_m_s, wanted_m_s, most_m_s, model.acceleration_m_s2, dt_s);
    state.speed_m_s = motion::magnitude(wanted_m_s) < motion::magnitude(from_m_s) ? wanted_m_s : faster_m_s;
    return HomingStep{state, {state.speed_m_s, turn_rad_s}};
  };
  if (!seen) {
    state.arrived = false;
    return drive(most_m_s, 0.0F);
  }
  // The sine, all but for a square root: of the larger and half of the smaller the length is within 12 %.
  const float a = motion::magnitude(ahead);
  const float l = motion::magnitude(left);
  const float length = a > l ? a + l / 2.0F : l + a / 2.0F;
  const float sine = length > 0.0F ? left / length : 0.0F;
  const bool behind = ahead < 0.0F;
  const float off_m = nearest_m / model.seen_part - model.behind_m - keep_m;
  const float bound_m = state.arrived ? model.gone_m : model.arrived_m;
  const float bound_sine = state.arrived ? model.gone_sine : model.arrived_sine;
  const bool within = !behind && motion::magnitude(off_m) <= bound_m && motion::magnitude(sine) <= bound_sine;
  state.beyond_s = within ? 0.0F : state.beyond_s + dt_s;
  state.arrived = within || (state.arrived && state.beyond_s < model.gone_s);
  if (state.arrived || most_m_s == 0.0F) {
    state.speed_m_s = 0.0F;
    return {state, {}};
  }
  const float side = left < 0.0F ? -1.0F : 1.0F;
  const float turn =
      behind ? side * model.most_turn_rad_s
             : motion::clamp(model.turn_gain_per_s * sine, -model.most_turn_rad_s, model.most_turn_rad_s);
  if (behind || motion::magnitude(sine) > model.ahead_sine) {
    state.speed_m_s = 0.0F;
    return {state, {0.0F, turn}};
  }
  const float wanted_m_s = motion::clamp(model.gain_per_s * off_m, -most_m_s, most_m_s);
  return drive(wanted_m_s, turn);
}

}  // namespace ocm::sensing
