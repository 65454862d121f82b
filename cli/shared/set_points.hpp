/// Set points of motors among the frames that are sent or received.
#pragma once

#include "ocm/can/frame.hpp"
#include "ocm/client/frame_index.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::cli {

/// The motors that the frame commands; nullptr if it is no set point of motors.
[[nodiscard]] const protocol::Topic* commanded_motors(const client::FrameIndex& index,
                                                      const can::Frame& frame);
/// The set point commands rest: every field is zero.
[[nodiscard]] inline bool is_rest(const can::Frame& set_point) {
  return set_point.data == can::Payload{};
}

}  // namespace ocm::cli
