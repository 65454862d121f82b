/// The states of a mapper, what each event does in each of them, and what its two lamps show. [T2 §6.3]
///
/// Pure and constexpr: an event in, the next state and what is to be done out; a table's worth of branches,
/// no memory, no clock. docs/mapper.md has the table; tests/unit/mapper/app/state.cpp goes through
/// every state with every event.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "ocm/base/time.hpp"
#include "ocm/mapper/app/parts.hpp"

namespace ocm::mapper::app {

enum class State : std::uint8_t {
  advertising,           ///< no link; gyro and compass are measured at rest, motors off
  connected,             ///< a link; says who it is each second until that is confirmed
  confirmed,             ///< all tasks run
  paused,                ///< the tower holds, no updates; set points are still obeyed
  calibrating,           ///< turns around once for its compass
  returning,             ///< no link, on the way home
  initialisation_fault,  ///< gyro or compass did not answer from the start
};
inline constexpr std::size_t state_count = 7;

[[nodiscard]] constexpr std::string_view name(State state) noexcept {
  constexpr std::array<std::string_view, state_count> names{
      "advertising", "connected", "confirmed", "paused", "calibrating", "returning", "initialisation fault"};
  return names[static_cast<std::size_t>(state)];
}

enum class Event : std::uint8_t {
  link_up,        ///< and the robot is measured: it may say who it is
  link_down,      ///< the dongle's pin
  confirm,        ///< {S,CON}
  pause,          ///< {S,PAU}
  unpause,        ///< {S,UNP}
  set_point,      ///< {U,angle,distance}
  stop,           ///< {U,0,0}
  format,         ///< {S,BIN} or {S,TXT}
  ping,           ///< {}
  who,            ///< {S,WHO}
  calibrate,      ///< {C,number} of a new one
  compass,        ///< {C,number} of the last one: what became of it
  calibrated,     ///< the turn is done, or given up
  return_due,     ///< the link has been gone for so long that the robot is to come home
  returned,       ///< home, or as near as it gets
  parts_failed,   ///< gyro or compass do not answer, and never did
  parts_answered  ///< they do now
};
inline constexpr std::size_t event_count = 17;

/// What an event makes of a state.
struct Step {
  State state = State::advertising;
  bool refused = false;     ///< not in this state: nothing happens, it is counted
  bool motors_off = false;  ///< at once, whatever is being done
  bool reset = false;       ///< a new operator: the pose is 0, the way home is empty
  bool drop = false;        ///< what waits for this link, or came from it, is gone
  bool drive = false;       ///< the set point is taken
  bool idle = false;        ///< say so
  bool answer = false;      ///< the ping, who it is, or how the compass is
  friend constexpr bool operator==(const Step&, const Step&) = default;
};

namespace detail {

/// In the states that the operator has confirmed, and to which he may speak.
[[nodiscard]] constexpr bool obeys(State state) noexcept {
  return state == State::confirmed || state == State::paused;
}
[[nodiscard]] constexpr bool has_link(State state) noexcept {
  return obeys(state) || state == State::connected || state == State::calibrating;
}

[[nodiscard]] constexpr Step to(State state) noexcept {
  return {.state = state};
}
[[nodiscard]] constexpr Step refused(State state) noexcept {
  return {.state = state, .refused = true};
}

[[nodiscard]] constexpr Step on_link_up(State state) noexcept {
  if (state != State::advertising && state != State::returning) return to(state);
  return {.state = State::connected, .motors_off = state == State::returning};
}
[[nodiscard]] constexpr Step on_link_down(State state) noexcept {
  if (!has_link(state)) return to(state);
  return {.state = State::advertising, .motors_off = true, .drop = true};
}
/// A second one is an operator who answered two handshakes: it changes nothing.
[[nodiscard]] constexpr Step on_confirm(State state) noexcept {
  if (state == State::connected) return {.state = State::confirmed, .reset = true};
  return has_link(state) ? to(state) : refused(state);
}
/// Idle is said again to who asks again: he may not have heard the first.
[[nodiscard]] constexpr Step on_pause(State state) noexcept {
  return obeys(state) ? Step{.state = State::paused, .idle = true} : refused(state);
}
[[nodiscard]] constexpr Step on_unpause(State state) noexcept {
  return obeys(state) ? to(State::confirmed) : refused(state);
}
[[nodiscard]] constexpr Step on_set_point(State state) noexcept {
  return obeys(state) ? Step{.state = state, .drive = true} : refused(state);
}
/// At once, and it ends a calibration, too.
[[nodiscard]] constexpr Step on_stop(State state) noexcept {
  if (!obeys(state) && state != State::calibrating) return refused(state);
  return {.state = obeys(state) ? state : State::confirmed, .motors_off = true, .idle = true};
}
/// Who is connected says so each second anyway.
[[nodiscard]] constexpr Step on_who(State state) noexcept {
  if (!has_link(state)) return refused(state);
  return {.state = state, .answer = state != State::connected};
}
[[nodiscard]] constexpr Step on_calibrate(State state) noexcept {
  if (state != State::confirmed) return refused(state);
  return {.state = State::calibrating, .motors_off = true, .answer = true};
}
[[nodiscard]] constexpr Step on_calibrated(State state) noexcept {
  if (state != State::calibrating) return to(state);
  return {.state = State::confirmed, .motors_off = true, .idle = true};
}
[[nodiscard]] constexpr Step on_returned(State state) noexcept {
  if (state != State::returning) return to(state);
  return {.state = State::advertising, .motors_off = true};
}

}  // namespace detail

[[nodiscard]] constexpr Step step(State state, Event event) noexcept {
  switch (event) {
    case Event::link_up:
      return detail::on_link_up(state);
    case Event::link_down:
      return detail::on_link_down(state);
    case Event::confirm:
      return detail::on_confirm(state);
    case Event::pause:
      return detail::on_pause(state);
    case Event::unpause:
      return detail::on_unpause(state);
    case Event::set_point:
      return detail::on_set_point(state);
    case Event::stop:
      return detail::on_stop(state);
    case Event::format:
      return detail::has_link(state) ? detail::to(state) : detail::refused(state);
    case Event::ping:
      return detail::has_link(state) ? Step{.state = state, .answer = true} : detail::refused(state);
    case Event::who:
      return detail::on_who(state);
    case Event::calibrate:
      return detail::on_calibrate(state);
    case Event::compass:
      return detail::has_link(state) ? Step{.state = state, .answer = true} : detail::refused(state);
    case Event::calibrated:
      return detail::on_calibrated(state);
    case Event::return_due:
      return detail::to(state == State::advertising ? State::returning : state);
    case Event::returned:
      return detail::on_returned(state);
    case Event::parts_failed:
      return detail::to(state == State::advertising ? State::initialisation_fault : state);
    case Event::parts_answered:
      return detail::to(state == State::initialisation_fault ? State::advertising : state);
  }
  return detail::to(state);
}

/// The motors may turn.
[[nodiscard]] constexpr bool may_drive(State state) noexcept {
  return detail::obeys(state) || state == State::calibrating || state == State::returning;
}
/// There is an operator at the other end, as far as the robot knows.
[[nodiscard]] constexpr bool has_link(State state) noexcept {
  return detail::has_link(state);
}
/// Set points are obeyed.
[[nodiscard]] constexpr bool obeys(State state) noexcept {
  return detail::obeys(state);
}

/// What the lamps depend on, besides the state.
struct LampTimes {
  base::Duration in_state{};     ///< since it began
  bool handshake = false;        ///< one was sent just now
  bool compass_at_rest = false;  ///< the compass corrects, and the robot stands
};

/// [T2 §6.3 and its figures 6.2 to 6.7; how long a flash is, and those marked "decided", are ours]
[[nodiscard]] constexpr Lights lights(State state, LampTimes times) noexcept {
  using namespace std::chrono_literals;
  const auto flashes = [&times](base::Duration period, base::Duration on) {
    return times.in_state % period < on;
  };
  switch (state) {
    case State::advertising:
      return {.green = flashes(2s, 200ms), .yellow = false};
    case State::connected:
      return {.green = true, .yellow = times.handshake};
    case State::confirmed:
      return {.green = true, .yellow = times.compass_at_rest};
    case State::paused:
      return {.green = true, .yellow = true};
    case State::calibrating:  // decided
      return {.green = true, .yellow = flashes(400ms, 200ms)};
    case State::returning:  // decided
      return {.green = flashes(1s, 500ms), .yellow = !flashes(1s, 500ms)};
    case State::initialisation_fault:  // decided: figure 6.7 is a picture that the text does not describe
      return {.green = false, .yellow = true};
  }
  return {};
}

}  // namespace ocm::mapper::app
