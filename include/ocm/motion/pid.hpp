/// PID with bounded output: real time steps, a filtered derivative, an integral that does not wind up.
///
///   u = Kp e + I + D,  I += Ki e dt,  D = Kd LP(c dr/dt - dy/dt),  LP first order with time constant tau
///
/// c weighs the reference in the derivative: 0 derives the measurement alone (no kick from a stepped set
/// point), 1 derives the error, as a moving reference needs: the thesis kept -dy/dt when its reference began
/// to move, and used a fixed period, and names both as faults [T2 §17.1].
///
/// Anti-windup: with tracking_s = 0 by clamping (in saturation the integral takes nothing that pushes
/// further), else by back-calculation, I += (u_bounded - u) dt/tracking_s. Either way I stays within the
/// output's bounds.
///
/// A pure step of some 20 float operations. A step with anything not finite, or with no time in it, changes
/// nothing but a counter, and the last output stands: who drives a motor looks at `rejected`.
#pragma once

#include <cstdint>

#include "ocm/motion/angle.hpp"
#include "ocm/motion/real.hpp"

namespace ocm::motion {

struct PidModel {
  float kp = 0.0F;
  float ki = 0.0F;                    ///< 1/s
  float kd = 0.0F;                    ///< s
  float derivative_filter_s = 0.0F;   ///< tau; 0: no filter
  float derivative_of_reference = 0;  ///< c, in [0, 1]
  float least = -1.0F;                ///< output
  float most = 1.0F;
  float tracking_s = 0.0F;  ///< back-calculation; 0: clamping
};

struct Pid {
  float integral = 0.0F;    ///< I, in units of the output
  float derivative = 0.0F;  ///< filtered, before Kd
  float reference = 0.0F;   ///< of the last step
  float measured = 0.0F;    ///< of the last step
  float output = 0.0F;
  bool started = false;  ///< the first step has nothing to derive
  std::uint32_t rejected = 0;
  friend bool operator==(const Pid&, const Pid&) = default;
};

namespace detail {

/// The integral by clamping: it grows until the output is at its bound, and no further.
constexpr float clamped(float integral, float change, float proportional, const PidModel& model) noexcept {
  const float room_up = model.most - proportional - integral;
  const float room_down = model.least - proportional - integral;
  return integral + clamp(change, room_down < 0.0F ? room_down : 0.0F, room_up > 0.0F ? room_up : 0.0F);
}

constexpr Pid pid_step(Pid state, float error, float reference_change, float measured_change, float dt_s,
                       const PidModel& model) noexcept {
  if (state.started) {
    const float rate = (model.derivative_of_reference * reference_change - measured_change) / dt_s;
    state.derivative += (rate - state.derivative) * dt_s / (model.derivative_filter_s + dt_s);
  }
  const float proportional = model.kp * error + model.kd * state.derivative;
  const float change = model.ki * error * dt_s;
  float integral = model.tracking_s > 0.0F ? state.integral + change
                                           : clamped(state.integral, change, proportional, model);
  const float wanted = proportional + integral;
  if (!is_finite(wanted)) return {.output = wanted};  // for pid_accept to see: clamp would hide it
  state.output = clamp(wanted, model.least, model.most);
  if (model.tracking_s > 0.0F && model.ki != 0.0F) {
    integral += (state.output - wanted) * clamp(dt_s / model.tracking_s, 0.0F, 1.0F);
  }
  state.integral = clamp(integral, model.least, model.most);
  state.started = true;
  return state;
}

/// The new state, or, where a number got lost, the old one and a count.
constexpr Pid pid_accept(Pid before, Pid after, float reference, float measured) noexcept {
  if (!all_finite(after.integral, after.derivative, after.output, reference, measured)) {
    ++before.rejected;
    return before;
  }
  after.reference = reference;
  after.measured = measured;
  return after;
}

constexpr Pid pid_reject(Pid state) noexcept {
  ++state.rejected;
  return state;
}

}  // namespace detail

/// One step of a quantity on a line.
[[nodiscard]] constexpr Pid control(Pid state, float reference, float measured, float dt_s,
                                    const PidModel& model) noexcept {
  if (!is_step(dt_s) || !all_finite(reference, measured)) return detail::pid_reject(state);
  const Pid next = detail::pid_step(state, reference - measured, reference - state.reference,
                                    measured - state.measured, dt_s, model);
  return detail::pid_accept(state, next, reference, measured);
}

/// One step of an angle: all differences the short way round.
[[nodiscard]] constexpr Pid control_angle(Pid state, float reference_rad, float measured_rad, float dt_s,
                                          const PidModel& model) noexcept {
  if (!is_step(dt_s) || !all_finite(reference_rad, measured_rad)) return detail::pid_reject(state);
  const Pid next = detail::pid_step(state, difference(reference_rad, measured_rad),
                                    difference(reference_rad, state.reference),
                                    difference(measured_rad, state.measured), dt_s, model);
  return detail::pid_accept(state, next, reference_rad, measured_rad);
}

}  // namespace ocm::motion
