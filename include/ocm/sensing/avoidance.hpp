/// Lets a round robot wander without touching anything, by the distances that a ring of eight sensors around
/// it sees: straight on where nothing is near, away from the nearer side, slower the nearer, and on the spot
/// towards the freer side where it does not go on.
///
/// A disc that turns on the spot touches nothing, so only the way ahead matters. There the speed is at most
/// gain * (what is free - what must stay free). Such an approach ends before the wall without running over,
/// as long as all the time that passes from a change of the distance to one of the speed is at most
/// `most_delay_s`.
///
/// Pure steps, constant time: some twenty float operations, no library call. constexpr.
#pragma once

#include <cstddef>
#include <cstdint>

#include "ocm/motion/limits.hpp"
#include "ocm/motion/pose.hpp"
#include "ocm/motion/real.hpp"
#include "ocm/sensing/ring_distance.hpp"

namespace ocm::sensing {

struct AvoidanceModel {
  float gain_per_s = 2.0F;         ///< speed for what is free ahead
  float keep_m = 0.045F;           ///< stays free ahead
  float keep_beside_m = 0.015F;    ///< and obliquely ahead, 67.5 degrees, where it passes by
  float turn_below_m = 0.075F;     ///< with less ahead it turns on the spot,
  float turn_until_m = 0.11F;      ///< until there is so much again
  float acceleration_m_s2 = 0.5F;  ///< it gets faster no sooner; slower at once
  float steer_rad_s = 2.0F;        ///< turn for something that is at one side only, and all but touched
  float turn_rad_s = 2.0F;         ///< on the spot
};

struct Avoidance {
  float speed_m_s = 0.0F;
  std::int8_t turning = 0;     ///< on the spot: 1 left, -1 right
  std::uint32_t rejected = 0;  ///< steps without a finite speed or without time: standing for that step
};

struct AvoidanceStep {
  Avoidance state{};
  motion::Twist command{};
};

/// The longest that anything may take from the sensors to the wheels' speed.
[[nodiscard]] constexpr float most_delay_s(const AvoidanceModel& model) noexcept {
  return motion::most_dead_time_s(model.gain_per_s);
}

/// One step at a speed of at most `most_m_s` (zero or more), `dt_s` after the last one.
[[nodiscard]] constexpr AvoidanceStep avoid(Avoidance state, const RingDistances& ring, float most_m_s,
                                            float dt_s, const AvoidanceModel& model) noexcept {
  if (!motion::is_finite(most_m_s) || most_m_s < 0.0F || !motion::is_step(dt_s)) {
    ++state.rejected;
    state.speed_m_s = 0.0F;
    return {state, {}};
  }
  const auto metres = [&ring](std::size_t sensor) { return static_cast<float>(ring[sensor]) / 1000.0F; };
  const auto nearer = [](float a, float b) { return a < b ? a : b; };
  const float left_m = nearer(metres(2), metres(3));
  const float right_m = nearer(metres(4), metres(5));
  const float ahead_m = nearer(metres(3), metres(4));
  const float beside_m = nearer(metres(2), metres(5));

  if (state.turning == 0 && ahead_m < model.turn_below_m) {
    // All of a side counts, also what is behind: it turns towards the freer one, and keeps to that.
    const auto four = [&ring](std::size_t first) {
      return std::uint32_t{ring[first]} + ring[first + 1] + ring[first + 2] + ring[first + 3];
    };
    state.turning = static_cast<std::int8_t>(four(0) >= four(4) ? 1 : -1);
  }
  if (state.turning != 0 && ahead_m > model.turn_until_m) state.turning = 0;
  if (state.turning != 0 || most_m_s == 0.0F) {
    state.speed_m_s = 0.0F;
    const float turn = most_m_s == 0.0F ? 0.0F : static_cast<float>(state.turning) * model.turn_rad_s;
    return {state, {0.0F, turn}};
  }

  const float free_m = nearer(ahead_m - model.keep_m, beside_m - model.keep_beside_m);
  const float wanted_m_s = motion::clamp(model.gain_per_s * free_m, 0.0F, most_m_s);
  const float faster_m_s =
      motion::limited(state.speed_m_s, wanted_m_s, most_m_s, model.acceleration_m_s2, dt_s);
  state.speed_m_s = wanted_m_s < state.speed_m_s ? wanted_m_s : faster_m_s;
  constexpr float range_m = static_cast<float>(ring_range_mm) / 1000.0F;
  const float steer = model.steer_rad_s * (left_m - right_m) / range_m;
  return {state, {state.speed_m_s, steer}};
}

}  // namespace ocm::sensing
