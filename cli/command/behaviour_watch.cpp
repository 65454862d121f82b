#include "cli/command/behaviour_watch.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "ocm/base/decimal.hpp"

#include "cli/shared/messages.hpp"

namespace ocm::cli {
namespace {

const protocol::Field* field_of(const protocol::Topic& topic, std::string_view name) {
  for (const auto& field : topic.frames[0].fields)
    if (field.name == name) return &field;
  return nullptr;
}

std::string name_of(const protocol::Field& field, std::int64_t raw) {
  for (const auto& value : field.values)
    if (value.raw == raw) return std::string{value.name};
  return fmt::format("{}", raw);
}

}  // namespace

const protocol::Topic& behaviour_topic(const protocol::Catalogue& catalogue, const std::string& verb,
                                       std::string_view name) {
  const protocol::Topic* const topic = catalogue.find(name);
  if (topic == nullptr || topic->kind != protocol::Kind::actuator)
    fail({fmt::format("{}: robot '{}' has no behaviour {}", verb, catalogue.robot, name),
          fmt::format("its spec has no actuator {}; see `amiroctl list`", name)});
  return *topic;
}

BehaviourWatch::BehaviourWatch(const protocol::Catalogue& catalogue, const std::string& verb,
                               std::string_view which)
    : index_(catalogue), sensor_(catalogue.find("behaviour")) {
  if (sensor_ != nullptr && sensor_->kind == protocol::Kind::sensor && sensor_->frames.size() == 1) {
    active_field_ = field_of(*sensor_, "active");
    ended_field_ = field_of(*sensor_, "ended");
  }
  if (active_field_ != nullptr && ended_field_ != nullptr)
    for (const auto& value : active_field_->values)
      if (value.name == which) which_ = value.raw;
  if (which_ == 0)
    fail({fmt::format("{}: robot '{}' does not say what becomes of {}", verb, catalogue.robot, which),
          fmt::format("its spec has no sensor behaviour whose field active has the value {}; use set",
                      which)});
}

void BehaviourWatch::begin() {
  last_.reset();
  active_ = was_active_ = false;
  inactive_ = 0;
}

void BehaviourWatch::take(const can::Received& received) {
  const auto subject = index_.subject(received.frame.id, received.frame.format);
  if (subject.topic != sensor_ || !subject.frame || received.frame.dlc != subject.frame.layout().dlc())
    return;
  last_ = Clock::now();
  const auto& data = received.frame.data;
  const std::int64_t active = active_field_->raw(data);
  const std::int64_t ended = ended_field_->raw(data);
  active_ = active == which_;
  was_active_ = was_active_ || active_;
  if (!was_active_) ++inactive_;
  ended_ = active != 0 && !active_ ? name_of(*active_field_, active) : name_of(*ended_field_, ended);
  left_.clear();
  for (const auto& field : sensor_->frames[0].fields) {
    if (&field == active_field_ || &field == ended_field_) continue;
    const auto physical = field.physical(field.raw(data));
    if (physical)
      left_ += fmt::format("{}{} {}", left_.empty() ? "" : ", ", base::to_text(*physical).view(), field.unit);
  }
}

}  // namespace ocm::cli
