/// Which topic a frame is of: the one place that knows. Built from a catalogue; one step a frame, whatever
/// the number of topics. 512 references and 256 pointers; constexpr, no heap.
///
///     const protocol::FrameIndex index{amiro::catalogue};
///     const auto subject = index.subject(protocol::Identifier::decode(frame.id));
///     if (subject.is_request()) ...
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::protocol {

/// What a frame is about: a request to a topic, or a frame of it.
struct Subject {
  const Topic* topic = nullptr;  ///< nullptr: the catalogue does not know the identifier
  FrameRef frame{};              ///< sensor data or a set point; empty for a request
  [[nodiscard]] constexpr bool is_request() const noexcept { return topic != nullptr && !frame; }
  constexpr explicit operator bool() const noexcept { return topic != nullptr; }
};

class FrameIndex {
 public:
  constexpr FrameIndex() = default;
  /// The catalogue must outlive the index.
  constexpr explicit FrameIndex(const Catalogue& catalogue) noexcept {
    for (const Topic& topic : catalogue.topics) {
      const bool sensor = topic.kind == Kind::sensor;
      if (sensor) requests_[topic.id.value] = &topic;
      for (std::size_t i = 0; i < topic.frames.size(); ++i) {
        auto& table = sensor ? sensors_ : actuators_;
        table[topic.frames[i].id.value] = {&topic, static_cast<std::uint8_t>(i)};
      }
    }
  }
  [[nodiscard]] constexpr Subject subject(Identifier id) const noexcept {
    if (const Topic* topic = requested(id)) return {topic, {}};
    const FrameRef frame = find(id);
    return {frame.topic, frame};
  }
  /// Sensor data, or an actuator's set point; empty for requests and unknown identifiers.
  [[nodiscard]] constexpr FrameRef find(Identifier id) const noexcept {
    return (id.direction == Direction::sensor ? sensors_ : actuators_)[id.topic.value];
  }
  /// The sensor that a command frame asks; nullptr otherwise.
  [[nodiscard]] constexpr const Topic* requested(Identifier id) const noexcept {
    return id.direction == Direction::command ? requests_[id.topic.value] : nullptr;
  }

 private:
  std::array<FrameRef, 256> sensors_{};
  std::array<FrameRef, 256> actuators_{};
  std::array<const Topic*, 256> requests_{};
};

}  // namespace ocm::protocol
