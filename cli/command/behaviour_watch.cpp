#include "cli/command/behaviour_watch.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "ocm/base/decimal.hpp"
#include "ocm/can/text.hpp"

#include "cli/shared/messages.hpp"
#include "cli/shared/set_points.hpp"

namespace ocm::cli {
namespace {

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
          fmt::format("its spec has no actuator {}; see `amiroctl list`", name)},
         exit_usage);
  return *topic;
}

BehaviourWatch::BehaviourWatch(const protocol::Catalogue& catalogue, const std::string& verb,
                               std::string_view which)
    : index_(catalogue), sensor_(catalogue), which_name_(which) {
  if (sensor_.exists())
    for (const auto& value : sensor_.active().values)
      if (value.name == which) which_ = value.raw;
  if (which_ == 0)
    fail(
        {fmt::format("{}: robot '{}' does not say what becomes of {}", verb, catalogue.robot, which),
         fmt::format("its spec has no sensor behaviour whose field active has the value {}; use set", which)},
        exit_usage);
}

void BehaviourWatch::begin() {
  last_.reset();
  active_ = was_active_ = false;
  inactive_ = 0;
  replaced_ = false;
  commanded_.clear();
}

void BehaviourWatch::take(const can::Received& received) {
  const auto* const behaviour = sensor_.commanded(index_, received.frame);
  const auto* const command = behaviour != nullptr ? behaviour : commanded_motors(index_, received.frame);
  if (command != nullptr) {
    const bool rest = is_rest(received.frame);
    // A rest of another behaviour ends nothing here.
    if (commanded_.empty() && (behaviour == nullptr || !rest || behaviour->name == which_name_))
      commanded_ = fmt::format("{} {}", command->name, can::to_text(received.frame).view());
    replaced_ = replaced_ || (behaviour != nullptr && !rest);
  }
  if (!sensor_.active_in(index_, received.frame)) return;
  last_ = Clock::now();
  if (replaced_) return;  // what it says after that is of the other one
  const auto& data = received.frame.data;
  const std::int64_t active = sensor_.active().raw(data);
  const std::int64_t ended = sensor_.ended().raw(data);
  active_ = active == which_;
  was_active_ = was_active_ || active_;
  if (!was_active_) ++inactive_;
  ended_ = active != 0 && !active_ ? name_of(sensor_.active(), active) : name_of(sensor_.ended(), ended);
  left_.clear();
  for (const auto& field : sensor().frames[0].fields) {
    if (&field == &sensor_.active() || &field == &sensor_.ended()) continue;
    const auto physical = field.physical(field.raw(data));
    if (physical)
      left_ += fmt::format("{}{} {}", left_.empty() ? "" : ", ", base::to_text(*physical).view(), field.unit);
  }
}

}  // namespace ocm::cli
