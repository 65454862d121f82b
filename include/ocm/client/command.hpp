/// What an operator commands: the frames to send now, and a set point to repeat. Programs fill it in, or make
/// it with the functions below. Host only.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/can/any_frame.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/j1939/broadcast.hpp"
#include "ocm/j1939/identifier.hpp"
#include "ocm/protocol/codec.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/request.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::client {

/// A set point that must be repeated, because the actuator comes to rest without it.
struct Hold {
  can::Frame frame;          ///< repeated every `hold_period`
  can::Frame rest;           ///< sent when the hold ends
  base::Duration lasting{};  ///< zero: until another drive or a stop
};
inline constexpr base::Duration hold_period{100'000'000};
/// Whether a set point commands rest: all its fields are zero.
[[nodiscard]] constexpr bool is_rest(const can::Frame& set_point) noexcept {
  const auto bytes = set_point.bytes();
  return std::all_of(bytes.begin(), bytes.end(), [](std::uint8_t byte) { return byte == 0; });
}
/// After this long without a set point a board's watchdog stops the motors, and a program that holds one must
/// not go on as if nothing had been. [spec/topics.json: watchdog of motors, 500 ms]
inline constexpr base::Duration longest_without_set_point{500'000'000};
/// What goes on longer than this without a set point, such as a travel, goes on without the program that gave
/// it, and must be ended. [decided]
inline constexpr base::Duration longest_watchdog{2'000'000'000};
/// How long a program listens for the set points of another one before it sends its first: a program that
/// holds one repeats it within this time, late as it may be by half a period. [decided]
inline constexpr base::Duration listen_before_hold{150'000'000};

/// That the frames of a command are sent again and again.
struct Repeat {
  base::Duration period{};
  base::Duration lasting{};  ///< zero: until something else with their identifier is sent
};
/// What has a shorter period would leave no time to anything else. [decided]
inline constexpr base::Duration shortest_repeat{100'000};

/// A message of J1939 that takes several frames, j1939::broadcast_distance apart.
struct Broadcast {
  const protocol::Topic* message = nullptr;  ///< outlives this
  std::vector<std::uint8_t> data;            ///< j1939::least_transported to most_transported bytes

  /// Of the message; its frames have others.
  [[nodiscard]] std::uint32_t id() const noexcept { return message->frames[0].address.number; }
  [[nodiscard]] std::uint32_t frames() const noexcept { return j1939::broadcast_frames(data.size()); }
  /// Of that number, below frames().
  [[nodiscard]] can::AnyFrame frame(std::uint32_t number) const noexcept {
    const auto part = j1939::broadcast_frame(j1939::Identifier::decode(id()), data, number);
    return can::Frame{part.id, can::max_dlc, part.data, can::Format::extended};
  }
};

struct Command {
  std::vector<can::Frame> frames;            ///< to send now, in this order
  std::vector<can::AnyFrame> fd_frames;      ///< to send behind them: a robot takes none, other buses do
  std::optional<Broadcast> broadcast;        ///< to begin now; then there are no others
  std::optional<Repeat> repeat;              ///< of all of these
  std::optional<Hold> hold;                  ///< drive
  bool ends_hold = false;                    ///< drive stop, stop, stop all
  const protocol::Topic* answers = nullptr;  ///< whose sample answers a publish or once

  /// Calls `take(const can::AnyFrame&)` for each frame to send now, and each of a broadcast.
  template <class Take>
  void each_frame(Take take) const {
    for (const auto& frame : frames) take(can::AnyFrame{frame});
    for (const auto& frame : fd_frames) take(frame);
    if (broadcast)
      for (std::uint32_t i = 0; i < broadcast->frames(); ++i) take(broadcast->frame(i));
  }
};

/// The set point of an actuator; fields that `raw` does not give are zero. O(fields).
[[nodiscard]] inline can::Frame set_point(const protocol::Topic& actuator, std::span<const std::int64_t> raw,
                                          std::optional<protocol::Priority> priority = {}) {
  const auto& layout = actuator.frames[0];
  can::Frame frame;
  frame.id =
      protocol::Identifier{protocol::Direction::command, priority.value_or(actuator.priority), layout.id}
          .encode();
  frame.dlc = layout.dlc();
  for (std::size_t i = 0; i < raw.size() && i < layout.fields.size(); ++i)
    protocol::put(frame.data, layout.fields[i].position, raw[i]);
  return frame;
}

/// Everything at rest: motors first, then what would command them again or come to rest by itself only later
/// (each actuator with a timeout), then every publisher. O(topics).
[[nodiscard]] inline Command stop_all(const protocol::Catalogue& catalogue,
                                      std::optional<protocol::Priority> priority = {}) {
  Command command;
  command.ends_hold = true;
  for (const auto& topic : catalogue.topics)
    if (topic.role == protocol::Role::drive) command.frames.push_back(set_point(topic, {}, priority));
  for (const auto& topic : catalogue.topics)
    if (topic.kind == protocol::Kind::actuator && topic.timeout.count() != 0 &&
        topic.role != protocol::Role::drive)
      command.frames.push_back(set_point(topic, {}, priority));
  for (const auto& topic : catalogue.topics)
    if (topic.kind == protocol::Kind::sensor)
      command.frames.push_back(protocol::stop(topic.id, priority.value_or(topic.priority)));
  return command;
}

}  // namespace ocm::client
