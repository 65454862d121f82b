#include "generator/text/messages.hpp"

namespace ocm::generate {

using protocol::Direction;
using protocol::Identifier;
using protocol::TopicId;

std::uint16_t Message::identifier(protocol::Priority priority) const noexcept {
  return Identifier{is_sensor() ? Direction::sensor : Direction::command, priority, TopicId{id}}.encode();
}

std::vector<Message> messages(const spec::Model& model) {
  std::vector<Message> all;
  for (const auto& topic : model.topics)
    for (unsigned instance = 0; instance < topic.count; ++instance)
      for (const auto& frame : topic.frames)
        for (unsigned i = 0; i < frame.count; ++i) {
          Message message{&topic, &frame, topic.name, frame.name, 0};
          if (topic.is_group) message.topic_name += "_" + std::to_string(instance + 1);
          if (frame.is_array) message.frame_name += "_" + std::to_string(i + 1);
          message.id = static_cast<std::uint8_t>(frame.id + instance + i);
          all.push_back(std::move(message));
        }
  return all;
}

std::uint16_t request_identifier(const spec::TopicModel& topic, protocol::Priority priority) {
  return Identifier{Direction::command, priority, TopicId{topic.id}}.encode();
}

std::string source_of(const Message& message, const spec::FieldModel& field) {
  for (const spec::Source* source : {&field.source, &message.frame->source, &message.topic->source})
    if (std::string text = source->joined(); !text.empty()) return text;
  return {};
}

}  // namespace ocm::generate
