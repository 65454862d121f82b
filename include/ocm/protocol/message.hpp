/// Typed frames of generated topics: from a struct to the frames on the bus.
#pragma once

#include <cstddef>
#include <cstdint>

#include "ocm/can/frame.hpp"
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

}  // namespace ocm::protocol
