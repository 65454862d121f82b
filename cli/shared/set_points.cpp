#include "cli/shared/set_points.hpp"

#include <algorithm>

#include "ocm/protocol/identifier.hpp"

namespace ocm::cli {

const protocol::Topic* commanded_motors(const client::FrameIndex& index, const can::Frame& frame) {
  if (frame.format != can::Format::base) return nullptr;
  const auto id = protocol::Identifier::decode(frame.id);
  if (id.direction != protocol::Direction::command) return nullptr;
  const protocol::FrameRef ref = index.find(id);
  const bool set_point = ref && ref.topic->role == protocol::Role::drive && frame.dlc == ref.layout().length;
  return set_point ? ref.topic : nullptr;
}

bool ends_travel(const protocol::Catalogue& catalogue, const client::Command& command) {
  const client::FrameIndex index{catalogue};
  return std::any_of(command.frames.begin(), command.frames.end(), [&](const can::Frame& frame) {
    const auto subject = index.subject(frame.id, frame.format);
    return subject.frame && subject.topic->kind == protocol::Kind::actuator &&
           subject.topic->timeout > client::longest_watchdog && is_rest(frame);
  });
}

}  // namespace ocm::cli
