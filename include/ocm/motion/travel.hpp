/// Takes a robot on two wheels a way straight ahead or back, then turns it on the spot, by what its wheels
/// did: slow motors, counters and a bound on the speed are all that it needs.
///
/// Each of the two is a proportional controller that the speed, and how fast it may grow, bound: the robot
/// sets off on a ramp, goes at its speed, and comes to the end as 1/gain says, without running over it. On
/// the way the heading is held. It has arrived when it was within tolerance for some steps, and ends, too,
/// when it took much longer than that way should: a wheel is blocked.
///
///     Travel state = started({.distance_m = 0.3F, .angle_rad = 0.0F, .speed_m_s = 0.1F}, model);
///     const TravelStep step = control(state, moved, dt_s, model);   // each period, until step.end
///
/// Pure steps, constant time: some twenty float operations, no library call. constexpr.
#pragma once

#include <cstdint>

#include "ocm/motion/limits.hpp"
#include "ocm/motion/pose.hpp"
#include "ocm/motion/real.hpp"

namespace ocm::motion {

struct TravelModel {
  float wheelbase_m = 0.0F;
  /// Speed for what is left. Below 1/(4 * lag of wheels and period), and with gain * speed below the
  /// acceleration, nothing is run over.
  float gain_per_s = 2.5F;
  float heading_gain_per_s = 2.5F;  ///< turn for a heading that is off, while it drives
  float acceleration_m_s2 = 1.0F;   ///< of a wheel: what sets off harder slips
  float distance_tolerance_m = 0.001F;
  float angle_tolerance_rad = 0.01F;
  std::uint8_t settled_steps = 3;  ///< within tolerance, one after the other
  float patience = 2.0F;           ///< it may take so many times as long as the way should,
  float patience_s = 5.0F;         ///< and so much more
};

/// What is asked for. First the way, then the turn.
struct TravelTarget {
  float distance_m = 0.0F;  ///< negative: backwards
  float angle_rad = 0.0F;   ///< left is positive; more than a turn is that many turns
  float speed_m_s = 0.0F;   ///< of the wheels, above zero
  friend bool operator==(const TravelTarget&, const TravelTarget&) = default;
};

/// What the wheels did in one period.
struct Moved {
  float ahead_m = 0.0F;
  float turn_rad = 0.0F;
  friend bool operator==(const Moved&, const Moved&) = default;
};

enum class TravelEnd : std::uint8_t {
  none,  ///< it goes on
  arrived,
  too_long,  ///< given up
};

struct Travel {
  enum class Phase : std::uint8_t { idle, driving, turning };

  Phase phase = Phase::idle;
  std::uint8_t settled = 0;
  float distance_left_m = 0.0F;
  float angle_left_rad = 0.0F;
  float heading_rad = 0.0F;  ///< since the start; the way ahead is 0
  float speed_m_s = 0.0F;
  float left_s = 0.0F;  ///< until it is given up
  Twist last{};
  std::uint32_t rejected = 0;  ///< steps without finite numbers or without time: standing for that step
};

struct TravelStep {
  Travel state{};
  Twist command{};
  TravelEnd end = TravelEnd::none;
};

/// How long the way takes at its speed, s. What is not finite or has no speed: 0.
[[nodiscard]] constexpr float duration_s(const TravelTarget& target, const TravelModel& model) noexcept {
  if (!all_finite(target.distance_m, target.angle_rad, target.speed_m_s) || target.speed_m_s <= 0.0F)
    return 0.0F;
  return (magnitude(target.distance_m) + magnitude(target.angle_rad) * model.wheelbase_m / 2.0F) /
         target.speed_m_s;
}

/// After so long it is given up, s.
[[nodiscard]] constexpr float longest_s(const TravelTarget& target, const TravelModel& model) noexcept {
  return model.patience * duration_s(target, model) + model.patience_s;
}

/// A new target from where the robot is. What is not finite or has no speed leaves it idle.
[[nodiscard]] constexpr Travel started(const TravelTarget& target, const TravelModel& model) noexcept {
  Travel state;
  if (!all_finite(target.distance_m, target.angle_rad, target.speed_m_s) || target.speed_m_s <= 0.0F)
    return state;
  state.phase = target.distance_m == 0.0F ? Travel::Phase::turning : Travel::Phase::driving;
  state.distance_left_m = target.distance_m;
  state.angle_left_rad = target.angle_rad;
  state.speed_m_s = target.speed_m_s;
  state.left_s = longest_s(target, model);
  return state;
}

namespace detail {

/// Counts steps within tolerance; true when there were enough.
constexpr bool settles(Travel& state, bool within, const TravelModel& model) noexcept {
  state.settled = within ? static_cast<std::uint8_t>(state.settled + 1) : std::uint8_t{0};
  return state.settled >= model.settled_steps;
}

}  // namespace detail

/// One step: `moved` since the last one, `dt_s` ago.
[[nodiscard]] constexpr TravelStep control(Travel state, Moved moved, float dt_s,
                                           const TravelModel& model) noexcept {
  using Phase = Travel::Phase;
  if (state.phase == Phase::idle) return {state, {}, TravelEnd::none};
  if (!all_finite(moved.ahead_m, moved.turn_rad) || !is_step(dt_s)) {
    ++state.rejected;
    state.last = {};
    return {state, {}, TravelEnd::none};
  }
  const auto ended = [&state](TravelEnd end) {
    state.phase = Phase::idle;
    state.last = {};
    return TravelStep{state, {}, end};
  };
  // A way at an angle to the one ahead brings the robot less far; the heading is held, so the angle is small
  // and its cosine 1 - a²/2.
  const float off_rad = clamp(state.heading_rad + moved.turn_rad / 2.0F, -1.0F, 1.0F);
  state.heading_rad += moved.turn_rad;
  state.distance_left_m -=
      state.phase == Phase::driving ? moved.ahead_m * (1.0F - off_rad * off_rad / 2.0F) : 0.0F;

  state.left_s -= dt_s;
  if (state.left_s < 0.0F) return ended(TravelEnd::too_long);

  const float half_base_m = model.wheelbase_m / 2.0F;
  const Limits limits{.speed_m_s = state.speed_m_s,
                      .acceleration_m_s2 = model.acceleration_m_s2,
                      .turn_rad_s = state.speed_m_s / half_base_m,
                      .turn_acceleration_rad_s2 = model.acceleration_m_s2 / half_base_m};
  if (state.phase == Phase::driving) {
    if (!detail::settles(state, magnitude(state.distance_left_m) <= model.distance_tolerance_m, model)) {
      const Twist wanted{model.gain_per_s * state.distance_left_m,
                         -model.heading_gain_per_s * state.heading_rad};
      state.last = limited(state.last, wanted, limits, dt_s);
      // Turning back to the way goes first, within the wheels' speed.
      const float ahead_m_s = state.speed_m_s - magnitude(state.last.turn_rad_s) * half_base_m;
      state.last.speed_m_s = clamp(state.last.speed_m_s, -ahead_m_s, ahead_m_s);
      return {state, state.last, TravelEnd::none};
    }
    if (state.angle_left_rad == 0.0F) return ended(TravelEnd::arrived);
    // What the heading is off at the end of the way is a part of the turn.
    state.angle_left_rad -= state.heading_rad;
    state.phase = Phase::turning;
    state.settled = 0;
    state.last = {};
  } else {
    state.angle_left_rad -= moved.turn_rad;
  }
  if (detail::settles(state, magnitude(state.angle_left_rad) <= model.angle_tolerance_rad, model))
    return ended(TravelEnd::arrived);
  state.last = limited(state.last, {0.0F, model.gain_per_s * state.angle_left_rad}, limits, dt_s);
  return {state, state.last, TravelEnd::none};
}

}  // namespace ocm::motion
