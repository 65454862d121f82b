#include "cli/shared/set_points.hpp"

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

}  // namespace ocm::cli
