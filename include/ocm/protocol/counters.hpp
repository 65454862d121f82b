/// What happened to the frames of a board, by cause: whatever is refused, late or lost is counted here and
/// nowhere silently gone. 32 bits each; they wrap.
#pragma once

#include <cstdint>
#include <string_view>

#include "ocm/base/result.hpp"

namespace ocm::protocol {

struct Counters {
  // frames from the bus
  std::uint32_t received = 0;  ///< handed to the board
  std::uint32_t foreign =
      0;  ///< not for this board: other boards' topics, sensor data, remote and extended frames
  std::uint32_t requests = 0;    ///< carried out
  std::uint32_t set_points = 0;  ///< carried out
  // refused, and nothing changed
  std::uint32_t bad_length = 0;
  std::uint32_t bad_mode = 0;
  std::uint32_t bad_unit = 0;
  std::uint32_t bad_period = 0;
  std::uint32_t not_served = 0;       ///< this board's topic, but nothing serves it
  std::uint32_t not_schedulable = 0;  ///< a stream would have missed its deadline
  std::uint32_t failed = 0;           ///< taken, and then a part would not: calibration, storage
  // frames to the bus
  std::uint32_t samples = 0;      ///< read and handed on
  std::uint32_t sent = 0;         ///< frames that the bus took
  std::uint32_t not_sampled = 0;  ///< the part delivered nothing: no frame for this release
  std::uint32_t overrun = 0;      ///< released while the last sample still waited for the bus: not sampled
  std::uint32_t late = 0;         ///< released later than the topic's jitter allows
  std::uint32_t missed = 0;       ///< releases skipped because a whole period had passed
  std::uint32_t send_failed = 0;  ///< the bus answered with an error: the rest of the sample given up
  // safety
  std::uint32_t timeouts = 0;  ///< actuators brought to rest because no set point came
  std::uint32_t bus_lost = 0;  ///< actuators brought to rest because the board lost the bus

  /// Counts a refused request.
  constexpr void refuse(base::Error cause) noexcept {
    switch (cause) {
      case base::Error::bad_mode:
        ++bad_mode;
        break;
      case base::Error::bad_unit:
        ++bad_unit;
        break;
      case base::Error::bad_period:
        ++bad_period;
        break;
      case base::Error::unknown_topic:
        ++not_served;
        break;
      case base::Error::not_schedulable:
        ++not_schedulable;
        break;
      case base::Error::bad_length:
        ++bad_length;
        break;
      default:
        ++failed;
        break;
    }
  }
  [[nodiscard]] constexpr std::uint32_t refused() const noexcept {
    return bad_length + bad_mode + bad_unit + bad_period + not_served + not_schedulable + failed;
  }
  friend constexpr bool operator==(const Counters&, const Counters&) = default;
};

/// Calls `f(name, value)` for every counter, in the order of declaration.
template <class F>
constexpr void for_each(const Counters& c, F&& f) {
  f(std::string_view{"received"}, c.received);
  f(std::string_view{"foreign"}, c.foreign);
  f(std::string_view{"requests"}, c.requests);
  f(std::string_view{"set_points"}, c.set_points);
  f(std::string_view{"bad_length"}, c.bad_length);
  f(std::string_view{"bad_mode"}, c.bad_mode);
  f(std::string_view{"bad_unit"}, c.bad_unit);
  f(std::string_view{"bad_period"}, c.bad_period);
  f(std::string_view{"not_served"}, c.not_served);
  f(std::string_view{"not_schedulable"}, c.not_schedulable);
  f(std::string_view{"failed"}, c.failed);
  f(std::string_view{"samples"}, c.samples);
  f(std::string_view{"sent"}, c.sent);
  f(std::string_view{"not_sampled"}, c.not_sampled);
  f(std::string_view{"overrun"}, c.overrun);
  f(std::string_view{"late"}, c.late);
  f(std::string_view{"missed"}, c.missed);
  f(std::string_view{"send_failed"}, c.send_failed);
  f(std::string_view{"timeouts"}, c.timeouts);
  f(std::string_view{"bus_lost"}, c.bus_lost);
}

}  // namespace ocm::protocol
