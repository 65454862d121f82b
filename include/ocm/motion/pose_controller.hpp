/// Takes the robot to a set point that is relative to where it is: first the angle, on the spot, then the
/// distance, straight on. [T2 §7.1, eq. 7.1, 7.2]
///
/// Each is a PID behind a reference model that starts at the present pose, and so does each new set point.
/// The distance done is measured from the pose at the start, by Pythagoras [T2 eq. 7.2], with the sign of the
/// way ahead, so that a robot that was pushed back is not sent further back. While it drives, the heading is
/// held.
///
/// It has arrived when the reference has, and the robot stayed within tolerance for some steps. A pose that
/// is not finite, or no time: motors off for that step, and counted. Two PID steps, a square root, a sin and
/// a cos.
#pragma once

#include <cmath>
#include <cstdint>

#include "ocm/motion/angle.hpp"
#include "ocm/motion/limits.hpp"
#include "ocm/motion/pid.hpp"
#include "ocm/motion/pose.hpp"
#include "ocm/motion/real.hpp"
#include "ocm/motion/reference_model.hpp"

namespace ocm::motion {

/// Relative to the robot's present pose.
struct SetPoint {
  float turn_rad = 0.0F;    ///< taken the short way round
  float distance_m = 0.0F;  ///< negative: backwards
  friend bool operator==(const SetPoint&, const SetPoint&) = default;
};

/// As a sentence says it: whole degrees, whole centimetres. [T2 table 4.3]
[[nodiscard]] constexpr SetPoint set_point(std::int32_t degrees, std::int32_t centimetres) noexcept {
  return {wrap(radians(static_cast<float>(degrees % 360))), static_cast<float>(centimetres) / 100.0F};
}

struct PoseControllerModel {
  PidModel heading{.kp = 1.0F, .derivative_of_reference = 1.0F};   ///< radians -> effort
  PidModel distance{.kp = 1.0F, .derivative_of_reference = 1.0F};  ///< metres -> effort
  ReferenceModel heading_reference{};
  ReferenceModel distance_reference{};
  float heading_tolerance_rad = radians(1.0F);
  float distance_tolerance_m = 0.01F;
  std::uint8_t settled_steps = 3;  ///< within tolerance, one after the other
};

struct PoseController {
  enum class Phase : std::uint8_t { idle, turning, driving };

  Phase phase = Phase::idle;
  SetPoint target{};
  Pose start{};
  float turn_reference_rad = 0.0F;    ///< from start.heading, in the direction of the target
  float distance_reference_m = 0.0F;  ///< from start
  Pid heading{};
  Pid distance{};
  std::uint8_t settled = 0;
  std::uint32_t rejected = 0;  ///< steps without a finite pose or without time; motors off
};

struct PoseCommand {
  Movement movement = Movement::standing;
  float ahead = 0.0F;    ///< effort, [-1, 1]
  float turn = 0.0F;     ///< effort, [-1, 1], left is positive
  bool arrived = false;  ///< in this very step: time to say idle, once
};

struct PoseControllerStep {
  PoseController state{};
  PoseCommand command{};
};

/// A new set point, from the present pose, whatever was going on. {0, 0} stops. One that is not finite, like
/// a pose that is not, stops as well, and is counted.
[[nodiscard]] constexpr PoseController started(const PoseController& before, SetPoint target,
                                               const Pose& present) noexcept {
  PoseController state;
  state.rejected = before.rejected;
  if (!all_finite(target.turn_rad, target.distance_m) || !is_finite(present)) {
    ++state.rejected;
    return state;
  }
  state.target = {wrap(target.turn_rad), target.distance_m};
  state.phase =
      state.target.turn_rad == 0.0F ? PoseController::Phase::driving : PoseController::Phase::turning;
  state.start = present;
  return state;
}

/// Motors off at once; the set point is forgotten. [T2 listing 8.2, and the loss of the link]
[[nodiscard]] constexpr PoseController stopped(const PoseController& before) noexcept {
  PoseController state;
  state.rejected = before.rejected;
  return state;
}

/// How far the robot is from where it started: ahead of it positive. [T2 eq. 7.2, with a sign]
[[nodiscard]] inline float distance_done(const Pose& start, float heading_rad, const Pose& now) noexcept {
  const float x = now.x_m - start.x_m;
  const float y = now.y_m - start.y_m;
  const float done = std::sqrt(x * x + y * y);
  return x * std::cos(heading_rad) + y * std::sin(heading_rad) < 0.0F ? -done : done;
}

namespace detail {

/// Counts steps within tolerance; true when there were enough.
constexpr bool settles(PoseController& state, bool within, const PoseControllerModel& model) noexcept {
  state.settled = within ? static_cast<std::uint8_t>(state.settled + 1) : std::uint8_t{0};
  return state.settled >= model.settled_steps;
}

}  // namespace detail

[[nodiscard]] inline PoseControllerStep control(PoseController state, const Pose& now, float dt_s,
                                                const PoseControllerModel& model) noexcept {
  using Phase = PoseController::Phase;
  if (state.phase == Phase::idle) return {state, {}};
  if (!is_finite(now) || !is_step(dt_s)) {
    ++state.rejected;
    return {state, {}};
  }

  const auto arrived = [&state] { return PoseControllerStep{stopped(state), {.arrived = true}}; };
  if (state.target == SetPoint{}) return arrived();

  const float goal_rad = wrap(state.start.heading_rad + state.target.turn_rad);
  if (state.phase == Phase::turning) {
    state.turn_reference_rad =
        approach(state.turn_reference_rad, state.target.turn_rad, model.heading_reference, dt_s);
    const float reference_rad = wrap(state.start.heading_rad + state.turn_reference_rad);
    state.heading = control_angle(state.heading, reference_rad, now.heading_rad, dt_s, model.heading);
    const bool within =
        magnitude(difference(goal_rad, now.heading_rad)) <= model.heading_tolerance_rad &&
        magnitude(state.target.turn_rad - state.turn_reference_rad) <= model.heading_tolerance_rad;
    if (!detail::settles(state, within, model)) {
      return {state, {Movement::rotating, 0.0F, state.heading.output, false}};
    }
    if (state.target.distance_m == 0.0F) return arrived();
    state.phase = Phase::driving;
    state.start.x_m = now.x_m;  // turning on the spot moves a real robot a little
    state.start.y_m = now.y_m;
    state.settled = 0;
    state.heading = {};
  }

  state.distance_reference_m =
      approach(state.distance_reference_m, state.target.distance_m, model.distance_reference, dt_s);
  const float done_m = distance_done(state.start, goal_rad, now);
  state.distance = control(state.distance, state.distance_reference_m, done_m, dt_s, model.distance);
  state.heading = control_angle(state.heading, goal_rad, now.heading_rad, dt_s, model.heading);
  const bool within =
      magnitude(state.target.distance_m - done_m) <= model.distance_tolerance_m &&
      magnitude(state.target.distance_m - state.distance_reference_m) <= model.distance_tolerance_m;
  if (!detail::settles(state, within, model)) {
    return {state, {Movement::straight, state.distance.output, state.heading.output, false}};
  }
  return arrived();
}

/// The command on two motors.
[[nodiscard]] constexpr Efforts efforts(const PoseCommand& command) noexcept {
  return mixed(command.ahead, command.turn);
}

}  // namespace ocm::motion
