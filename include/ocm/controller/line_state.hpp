/// The states of a line robot, what each event does in each of them, and what its two lamps show. [T2 §6.3]
///
/// Pure and constexpr: an event in, the next state and what is to be done out; a table's worth of branches,
/// no memory, no clock. docs/line-robot.md has the table; tests/unit/controller/line_state.cpp goes through
/// every state with every event.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "ocm/base/time.hpp"
#include "ocm/controller/line_parts.hpp"

namespace ocm::controller {

enum class LineState : std::uint8_t {
  advertising,           ///< no link; gyro and compass are measured at rest, motors off
  connected,             ///< a link; says who it is each second until that is confirmed
  confirmed,             ///< all tasks run
  paused,                ///< the tower holds, no updates; set points are still obeyed
  calibrating,           ///< turns around once for its compass
  returning,             ///< no link, on the way home
  initialisation_fault,  ///< gyro or compass did not answer from the start
};
inline constexpr std::size_t line_states = 7;

[[nodiscard]] constexpr std::string_view name(LineState state) noexcept {
  constexpr std::array<std::string_view, line_states> names{
      "advertising", "connected", "confirmed", "paused", "calibrating", "returning", "initialisation fault"};
  return names[static_cast<std::size_t>(state)];
}

enum class LineEvent : std::uint8_t {
  link_up,        ///< and the robot is measured: it may say who it is
  link_down,      ///< the dongle's pin
  confirm,        ///< {S,CON}
  pause,          ///< {S,PAU}
  unpause,        ///< {S,UNP}
  set_point,      ///< {U,angle,distance}
  stop,           ///< {U,0,0}
  format,         ///< {S,BIN} or {S,TXT}
  ping,           ///< {}
  calibrate,      ///< by the robot's own program
  calibrated,     ///< the turn is done, or given up
  return_due,     ///< the link has been gone for so long that the robot is to come home
  returned,       ///< home, or as near as it gets
  parts_failed,   ///< gyro or compass do not answer, and never did
  parts_answered  ///< they do now
};
inline constexpr std::size_t line_events = 15;

/// What an event makes of a state.
struct LineStep {
  LineState state = LineState::advertising;
  bool refused = false;     ///< not in this state: nothing happens, it is counted
  bool motors_off = false;  ///< at once, whatever is being done
  bool reset = false;       ///< a new operator: the pose is 0, the way home is empty
  bool drop = false;        ///< what waits for this link, or came from it, is gone
  bool drive = false;       ///< the set point is taken
  bool idle = false;        ///< say so
  bool answer = false;      ///< the ping
  friend constexpr bool operator==(const LineStep&, const LineStep&) = default;
};

namespace detail {

/// In the states that the operator has confirmed, and to which he may speak.
[[nodiscard]] constexpr bool obeys(LineState state) noexcept {
  return state == LineState::confirmed || state == LineState::paused;
}
[[nodiscard]] constexpr bool has_link(LineState state) noexcept {
  return obeys(state) || state == LineState::connected || state == LineState::calibrating;
}

[[nodiscard]] constexpr LineStep to(LineState state) noexcept {
  return {.state = state};
}
[[nodiscard]] constexpr LineStep refused(LineState state) noexcept {
  return {.state = state, .refused = true};
}

[[nodiscard]] constexpr LineStep on_link_up(LineState state) noexcept {
  if (state != LineState::advertising && state != LineState::returning) return to(state);
  return {.state = LineState::connected, .motors_off = state == LineState::returning};
}
[[nodiscard]] constexpr LineStep on_link_down(LineState state) noexcept {
  if (!has_link(state)) return to(state);
  return {.state = LineState::advertising, .motors_off = true, .drop = true};
}
/// A second one is an operator who answered two handshakes: it changes nothing.
[[nodiscard]] constexpr LineStep on_confirm(LineState state) noexcept {
  if (state == LineState::connected) return {.state = LineState::confirmed, .reset = true};
  return has_link(state) ? to(state) : refused(state);
}
/// Idle is said again to who asks again: he may not have heard the first.
[[nodiscard]] constexpr LineStep on_pause(LineState state) noexcept {
  return obeys(state) ? LineStep{.state = LineState::paused, .idle = true} : refused(state);
}
[[nodiscard]] constexpr LineStep on_unpause(LineState state) noexcept {
  return obeys(state) ? to(LineState::confirmed) : refused(state);
}
[[nodiscard]] constexpr LineStep on_set_point(LineState state) noexcept {
  return obeys(state) ? LineStep{.state = state, .drive = true} : refused(state);
}
/// At once, and it ends a calibration, too.
[[nodiscard]] constexpr LineStep on_stop(LineState state) noexcept {
  if (!obeys(state) && state != LineState::calibrating) return refused(state);
  return {.state = obeys(state) ? state : LineState::confirmed, .motors_off = true, .idle = true};
}
[[nodiscard]] constexpr LineStep on_calibrate(LineState state) noexcept {
  if (state != LineState::confirmed) return refused(state);
  return {.state = LineState::calibrating, .motors_off = true};
}
[[nodiscard]] constexpr LineStep on_calibrated(LineState state) noexcept {
  if (state != LineState::calibrating) return to(state);
  return {.state = LineState::confirmed, .motors_off = true, .idle = true};
}
[[nodiscard]] constexpr LineStep on_returned(LineState state) noexcept {
  if (state != LineState::returning) return to(state);
  return {.state = LineState::advertising, .motors_off = true};
}

}  // namespace detail

[[nodiscard]] constexpr LineStep step(LineState state, LineEvent event) noexcept {
  switch (event) {
    case LineEvent::link_up:
      return detail::on_link_up(state);
    case LineEvent::link_down:
      return detail::on_link_down(state);
    case LineEvent::confirm:
      return detail::on_confirm(state);
    case LineEvent::pause:
      return detail::on_pause(state);
    case LineEvent::unpause:
      return detail::on_unpause(state);
    case LineEvent::set_point:
      return detail::on_set_point(state);
    case LineEvent::stop:
      return detail::on_stop(state);
    case LineEvent::format:
      return detail::has_link(state) ? detail::to(state) : detail::refused(state);
    case LineEvent::ping:
      return detail::has_link(state) ? LineStep{.state = state, .answer = true} : detail::refused(state);
    case LineEvent::calibrate:
      return detail::on_calibrate(state);
    case LineEvent::calibrated:
      return detail::on_calibrated(state);
    case LineEvent::return_due:
      return detail::to(state == LineState::advertising ? LineState::returning : state);
    case LineEvent::returned:
      return detail::on_returned(state);
    case LineEvent::parts_failed:
      return detail::to(state == LineState::advertising ? LineState::initialisation_fault : state);
    case LineEvent::parts_answered:
      return detail::to(state == LineState::initialisation_fault ? LineState::advertising : state);
  }
  return detail::to(state);
}

/// The motors may turn.
[[nodiscard]] constexpr bool may_drive(LineState state) noexcept {
  return detail::obeys(state) || state == LineState::calibrating || state == LineState::returning;
}
/// There is an operator at the other end, as far as the robot knows.
[[nodiscard]] constexpr bool has_link(LineState state) noexcept {
  return detail::has_link(state);
}
/// Set points are obeyed.
[[nodiscard]] constexpr bool obeys(LineState state) noexcept {
  return detail::obeys(state);
}

/// What the lamps depend on, besides the state.
struct LampTimes {
  base::Duration in_state{};     ///< since it began
  bool handshake = false;        ///< one was sent just now
  bool compass_at_rest = false;  ///< the compass corrects, and the robot stands
};

/// [T2 §6.3 and its figures 6.2 to 6.7; how long a flash is, and those marked "decided", are ours]
[[nodiscard]] constexpr Lights lights(LineState state, LampTimes times) noexcept {
  using namespace std::chrono_literals;
  const auto flashes = [&times](base::Duration period, base::Duration on) {
    return times.in_state % period < on;
  };
  switch (state) {
    case LineState::advertising:
      return {.green = flashes(2s, 200ms), .yellow = false};
    case LineState::connected:
      return {.green = true, .yellow = times.handshake};
    case LineState::confirmed:
      return {.green = true, .yellow = times.compass_at_rest};
    case LineState::paused:
      return {.green = true, .yellow = true};
    case LineState::calibrating:  // decided
      return {.green = true, .yellow = flashes(400ms, 200ms)};
    case LineState::returning:  // decided
      return {.green = flashes(1s, 500ms), .yellow = !flashes(1s, 500ms)};
    case LineState::initialisation_fault:  // decided: figure 6.7 is a picture that the text does not describe
      return {.green = false, .yellow = true};
  }
  return {};
}

}  // namespace ocm::controller
