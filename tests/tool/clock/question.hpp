/// Before a program commands the motors it may ask, once, what the boards do by themselves; behind all that
/// it has commanded, whether the wheels' board is there.
#pragma once

#include <vector>

#include "ocm/protocol/request.hpp"
#include "ocm/topics/amiro.hpp"

#include "cli/shared/behaviour_sensor.hpp"
#include "tests/tool/clock/played_bus.hpp"

namespace ocm::test {

/// The request for one sample of the sensor `behaviour`.
inline can::Frame question() {
  return cli::BehaviourSensor{amiro::catalogue}.request();
}

/// The request for one sample of its status.
inline can::Frame status_question() {
  return protocol::once(amiro::DiWheelDriveStatus::id, amiro::DiWheelDriveStatus::priority);
}

/// All that was sent but one question, which comes before everything else. A second one, or a later one, is
/// left in.
inline std::vector<PlayedBus::Sent> after_question(std::vector<PlayedBus::Sent> sent) {
  if (!sent.empty() && sent.front().frame == question()) sent.erase(sent.begin());
  return sent;
}

}  // namespace ocm::test
