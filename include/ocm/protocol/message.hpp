/// Typed frames of generated topics and messages: from a struct to the frames on the bus, and back.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "ocm/can/frame.hpp"
#include "ocm/j1939/identifier.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::protocol {

/// The identifier number of frame `index` of instance `instance` (1..T::instances).
template <TopicType T>
[[nodiscard]] constexpr TopicId frame_id(std::size_t index, std::uint8_t instance = 1) noexcept {
  return TopicId{static_cast<std::uint8_t>(T::frames[index].id.value + instance - 1)};
}

/// Frame `index` of a sample, as a board sends it.
template <TopicType T>
[[nodiscard]] constexpr can::Frame sample_frame(const T& sample, Priority priority = T::priority,
                                                std::size_t index = 0) noexcept {
  static_assert(T::kind == Kind::sensor, "an actuator sends no samples");
  return {Identifier{Direction::sensor, priority, frame_id<T>(index)}.encode(), T::frames[index].dlc,
          sample.encode(index)};
}

/// An actuator's set point as its one frame.
template <TopicType T>
[[nodiscard]] constexpr can::Frame command(const T& set_point, Priority priority = T::priority,
                                           std::uint8_t instance = 1) noexcept {
  static_assert(T::kind == Kind::actuator, "only an actuator takes set points");
  static_assert(T::frames.size() == 1, "a set point travels in one frame");
  return {Identifier{Direction::command, priority, frame_id<T>(0, instance)}.encode(), T::frames[0].dlc,
          set_point.encode(0)};
}

/// What the generator writes of a plain message: its bytes, with accessors for what they mean.
template <class T>
concept MessageType = requires(T message) {
  { T::address } -> std::convertible_to<Address>;
  { T::length } -> std::convertible_to<std::size_t>;
  { message.bytes.data() } -> std::same_as<std::uint8_t*>;
};

/// Whether a frame is this message: its identifier, of J1939 its parameter group, and its format are.
template <MessageType T>
[[nodiscard]] constexpr bool is_message(const can::Frame& frame) noexcept {
  constexpr Address address = T::address;
  if (frame.format != (address.extended ? can::Format::extended : can::Format::base)) return false;
  if constexpr (address.by == Address::By::pgn)
    return j1939::pgn_of(frame.id) == j1939::pgn_of(address.number);
  else
    return frame.id == address.number;
}

/// The message in so many bytes; nothing where they are fewer than it has. Those beyond mean nothing.
template <MessageType T>
[[nodiscard]] constexpr std::optional<T> message_from(std::span<const std::uint8_t> data) noexcept {
  if (data.size() < T::length) return std::nullopt;
  T message;
  std::copy_n(data.begin(), T::length, message.bytes.begin());
  return message;
}

/// The message in a frame, if it is one and long enough.
template <MessageType T>
[[nodiscard]] constexpr std::optional<T> message_from(const can::Frame& frame) noexcept {
  if (!is_message<T>(frame)) return std::nullopt;
  return message_from<T>(frame.bytes());
}

/// The message as a classic frame; of J1939 with the priority and the source of its address.
template <MessageType T>
requires(T::length <= can::max_dlc && !T::fd) [[nodiscard]] constexpr can::Frame
    message_frame(const T& message) noexcept {
  can::Frame frame{T::address.number,
                   static_cast<std::uint8_t>(T::length),
                   {},
                   T::address.extended ? can::Format::extended : can::Format::base};
  std::copy_n(message.bytes.begin(), T::length, frame.data.begin());
  return frame;
}

}  // namespace ocm::protocol
