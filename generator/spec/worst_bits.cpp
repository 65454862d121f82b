#include "generator/spec/worst_bits.hpp"

#include <memory>

#include "ocm/can/worst_bits.hpp"

namespace ocm::spec {

protocol::BitsByPriority worst_bits(protocol::Kind kind, unsigned id, std::uint8_t dlc) {
  static const auto table = std::make_unique<const can::WorstBits>();
  // What carries a topic's fields: samples come from a sensor, set points go to an actuator.
  const auto direction =
      kind == protocol::Kind::sensor ? protocol::Direction::sensor : protocol::Direction::command;
  protocol::BitsByPriority bits{};
  for (std::size_t level = 0; level < bits.size(); ++level) {
    const protocol::Identifier identifier{direction, static_cast<protocol::Priority>(level),
                                          protocol::TopicId{static_cast<std::uint8_t>(id)}};
    bits[level] = static_cast<std::uint8_t>(table->bits(identifier.encode(), can::Format::base, dlc));
  }
  return bits;
}

}  // namespace ocm::spec
