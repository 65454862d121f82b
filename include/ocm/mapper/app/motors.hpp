/// From the pose controller's command to what each motor gets: the mapper's movement task, as a pure
/// step. [T2 §7.1, §7.1.1, §10.2.3]
///
/// The AVR robot's motors hardly know more than on and off: one effort for both, never below what turns them,
/// and the wheel that is a tick ahead waits. The Arduino robot's have a PI controller each, one following the
/// other. Some float operations, constexpr, no clock: the time that passed is handed in.
#pragma once

#include <cstdint>

#include "ocm/mapper/app/parts.hpp"
#include "ocm/motion/limits.hpp"
#include "ocm/motion/odometry.hpp"
#include "ocm/motion/pose_controller.hpp"
#include "ocm/motion/real.hpp"
#include "ocm/motion/soft_pwm.hpp"
#include "ocm/motion/tick_gate.hpp"
#include "ocm/motion/wheel_pi.hpp"

namespace ocm::mapper::app {

enum class MotorKind : std::uint8_t {
  gated,   ///< on or off, kept at one pace by ticks: the AVR robot
  paced,   ///< a PI controller a wheel: the Arduino robot
  direct,  ///< the efforts as they are: wheels without an encoder
};

struct MotorModel {
  MotorKind kind = MotorKind::gated;
  /// An effort below this is none: it would only make the robot twitch around its goal.
  float dead_band = 0.05F;
  motion::SoftPwm pwm{};            ///< gated: the least share of a slot that turns a motor
  motion::WheelPiModel wheel_pi{};  ///< paced
  float most_ticks_s = 0.0F;        ///< paced: what a wheel makes at full effort
};

struct Motors {
  motion::PoseCommand command{};  ///< what it was before
  WheelTicks start{};             ///< gated: when this movement began
  WheelTicks last{};
  motion::WheelPi wheel_pi{};
};

struct MotorStep {
  Motors state{};
  motion::Efforts efforts{};
};

namespace detail {

/// What one motor of a robot that knows on and off gets: at least what turns it, or nothing.
[[nodiscard]] constexpr float switched(float effort, const MotorModel& model) noexcept {
  const motion::MotorDuty duty = motion::duty(effort, model.dead_band, model.pwm);
  const float share = static_cast<float>(duty.percent) / 100.0F;
  return duty.forward ? share : -share;
}

/// The robot goes on as before: the same movement, the same way.
[[nodiscard]] constexpr bool goes_on(const motion::PoseCommand& before,
                                     const motion::PoseCommand& now) noexcept {
  const float was = before.movement == motion::Movement::rotating ? before.turn : before.ahead;
  const float is = now.movement == motion::Movement::rotating ? now.turn : now.ahead;
  return before.movement == now.movement && (was > 0.0F) == (is > 0.0F);
}

[[nodiscard]] constexpr motion::Efforts gated(const Motors& state, const motion::PoseCommand& command,
                                              WheelTicks ticks, const MotorModel& model) noexcept {
  const bool rotates = command.movement == motion::Movement::rotating;
  const float left = switched(rotates ? -command.turn : command.ahead, model);
  const float right = switched(rotates ? command.turn : command.ahead, model);
  const motion::WheelGate gate =
      motion::gate(state.start.left, ticks.left, left >= 0.0F, state.start.right, ticks.right, right >= 0.0F);
  return {gate.left ? left : 0.0F, gate.right ? right : 0.0F};
}

[[nodiscard]] constexpr float ticks_per_s(std::uint32_t before, std::uint32_t now, float dt_s) noexcept {
  return motion::magnitude(static_cast<float>(motion::ticks_between(before, now))) / dt_s;
}

[[nodiscard]] constexpr MotorStep paced(Motors state, const motion::PoseCommand& command, WheelTicks ticks,
                                        float dt_s, const MotorModel& model) noexcept {
  const motion::Efforts wanted = motion::mixed(command.ahead, command.turn);
  const float left = motion::magnitude(wanted.left);
  const float right = motion::magnitude(wanted.right);
  motion::WheelPiModel pi = model.wheel_pi;
  const float master = pi.right_is_master ? right : left;
  const float slave = pi.right_is_master ? left : right;
  const bool off = master < model.dead_band || !motion::is_step(dt_s);
  pi.slave_per_master *= off ? 1.0F : slave / master;
  const motion::WheelRates measured =
      off ? motion::WheelRates{}
          : motion::WheelRates{ticks_per_s(state.last.left, ticks.left, dt_s),
                               ticks_per_s(state.last.right, ticks.right, dt_s)};
  const auto step =
      motion::control(state.wheel_pi, off ? 0.0F : master * model.most_ticks_s, measured, dt_s, pi);
  state.wheel_pi = step.state;
  return {state,
          {wanted.left < 0.0F ? -step.efforts.left : step.efforts.left,
           wanted.right < 0.0F ? -step.efforts.right : step.efforts.right}};
}

}  // namespace detail

/// One step. A command that is not finite is rest, like none.
[[nodiscard]] constexpr MotorStep move(Motors state, const motion::PoseCommand& command, WheelTicks ticks,
                                       float dt_s, const MotorModel& model) noexcept {
  const bool stands =
      command.movement == motion::Movement::standing || !motion::all_finite(command.ahead, command.turn);
  if (stands || !detail::goes_on(state.command, command)) state = {.start = ticks, .last = ticks};
  state.command = stands ? motion::PoseCommand{} : command;
  MotorStep result{state, {}};
  if (!stands) switch (model.kind) {
      case MotorKind::gated:
        result.efforts = detail::gated(state, command, ticks, model);
        break;
      case MotorKind::paced:
        result = detail::paced(state, command, ticks, dt_s, model);
        break;
      case MotorKind::direct:
        result.efforts = motion::efforts(command);
        break;
    }
  result.state.last = ticks;
  return result;
}

}  // namespace ocm::mapper::app
