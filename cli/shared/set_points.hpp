/// Set points of motors among the frames that are sent or received.
#pragma once

#include "ocm/can/frame.hpp"
#include "ocm/client/command.hpp"
#include "ocm/client/frame_index.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::cli {

/// The motors that the frame commands; nullptr if it is no set point of motors.
[[nodiscard]] const protocol::Topic* commanded_motors(const client::FrameIndex& index,
                                                      const can::Frame& frame);
using client::is_rest;

/// Zeros that end a motion: of motors, or of what a board does by itself until a time has passed. No limit
/// and no permission is asked for them.
[[nodiscard]] inline bool ends_motion(const protocol::Topic& topic, const can::Frame& set_point) {
  return (topic.role == protocol::Role::drive || topic.timeout.count() != 0) && is_rest(set_point);
}

/// Whether it ends what no watchdog ends soon, such as a travel.
[[nodiscard]] bool ends_travel(const protocol::Catalogue& catalogue, const client::Command& command);

}  // namespace ocm::cli
