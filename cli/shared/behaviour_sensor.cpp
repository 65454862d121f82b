#include "cli/shared/behaviour_sensor.hpp"

#include <algorithm>

#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/request.hpp"

namespace ocm::cli {

BehaviourSensor::BehaviourSensor(const protocol::Catalogue& catalogue) : topic_(catalogue.find("behaviour")) {
  if (topic_ == nullptr || topic_->kind != protocol::Kind::sensor || topic_->frames.size() != 1) return;
  const protocol::Field* active = nullptr;
  for (const auto& field : topic_->frames[0].fields) {
    if (field.name == "active") active = &field;
    if (field.name == "ended") ended_ = &field;
  }
  if (ended_ != nullptr) active_ = active;
}

std::optional<std::string_view> BehaviourSensor::active_in(const client::FrameIndex& index,
                                                           const can::Frame& frame) const {
  if (!exists()) return std::nullopt;
  const auto subject = index.subject(frame.id, frame.format);
  if (subject.topic != topic_ || !subject.frame || frame.dlc != subject.frame.layout().dlc())
    return std::nullopt;
  const std::int64_t raw = active_->raw(frame.data);
  if (raw == 0) return std::string_view{};
  for (const auto& value : active_->values)
    if (value.raw == raw) return value.name;
  return "an unknown behaviour";
}

const protocol::Topic* BehaviourSensor::commanded(const client::FrameIndex& index,
                                                  const can::Frame& frame) const {
  if (!exists() || frame.format != can::Format::base) return nullptr;
  const auto id = protocol::Identifier::decode(frame.id);
  if (id.direction != protocol::Direction::command) return nullptr;
  const protocol::FrameRef ref = index.find(id);
  if (!ref || ref.topic->kind != protocol::Kind::actuator || frame.dlc != ref.layout().length) return nullptr;
  const bool known = std::any_of(active_->values.begin(), active_->values.end(),
                                 [&](const auto& value) { return value.name == ref.topic->name; });
  return known ? ref.topic : nullptr;
}

can::Frame BehaviourSensor::request() const {
  return protocol::once(topic_->id, topic_->priority);
}

}  // namespace ocm::cli
