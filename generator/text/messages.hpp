/// The robot's frames one by one, groups and arrays written out: what formats that know neither are made
/// from.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "generator/spec/model.hpp"

namespace ocm::generate {

/// A frame with samples or a set point.
struct Message {
  const spec::TopicModel* topic = nullptr;
  const spec::FrameModel* frame = nullptr;
  std::string topic_name;  ///< "led_3" of a group
  std::string frame_name;  ///< "sensor_1"; empty for a topic's only frame
  std::uint8_t id = 0;     ///< its number on the bus

  [[nodiscard]] bool is_sensor() const noexcept { return topic->kind == protocol::Kind::sensor; }
  [[nodiscard]] std::uint16_t identifier(protocol::Priority priority) const noexcept;
};

/// In the order of the spec. They point into the model.
[[nodiscard]] std::vector<Message> messages(const spec::Model& model);

/// The identifier of a request to a sensor.
[[nodiscard]] std::uint16_t request_identifier(const spec::TopicModel& topic, protocol::Priority priority);

/// "_urgent" to "_low".
inline constexpr protocol::Priority priorities[] = {protocol::Priority::urgent, protocol::Priority::high,
                                                    protocol::Priority::medium, protocol::Priority::low};

/// The names of a request's mode and of the unit of its period, by number. [protocol.md, Requests]
inline constexpr std::string_view mode_names[] = {"stop", "publish", "once"};
inline constexpr std::string_view unit_names[] = {"ms", "s", "us"};

/// Where the facts of a field come from: its own source, or that of what is around it.
[[nodiscard]] std::string source_of(const Message& message, const spec::FieldModel& field);

}  // namespace ocm::generate
