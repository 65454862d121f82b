/// Set points of one actuator that two nodes send in turns: two programs that command it, each within the
/// other's timeout. On the wire the sender of a frame is not known; the simulator knows it.
#pragma once

#include <array>
#include <cstdint>

#include "ocm/base/time.hpp"
#include "ocm/client/command.hpp"
#include "ocm/client/frame_index.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/simulation/arbiter.hpp"

namespace ocm::sim {

class Turns {
 public:
  /// The catalogue must outlive it.
  explicit Turns(const protocol::Catalogue& catalogue) : index_(catalogue) {}

  /// A frame that was on the bus. The zero with which a program ends, because another one has stopped the
  /// actuator, is no turn. O(1).
  void take(const simulation::Delivery& delivery) {
    if (delivery.frame.format != can::Format::base) return;
    const auto id = protocol::Identifier::decode(delivery.frame.id);
    if (id.direction != protocol::Direction::command) return;
    const protocol::FrameRef ref = index_.find(id);
    if (!ref || ref.topic->timeout.count() == 0) return;
    Senders& senders = senders_[id.topic.value];
    senders.topic = ref.topic;
    if (delivery.from != senders.last) {
      if (delivery.from == senders.before && delivery.time - senders.before_time < ref.topic->timeout &&
          !client::is_rest(delivery.frame))
        ++senders.turns;
      senders.before = senders.last;
      senders.before_time = senders.last_time;
      senders.last = delivery.from;
    }
    senders.last_time = delivery.time;
  }

  /// Calls `tell(topic, turns)` for each actuator that was commanded so.
  template <class Tell>
  void each(Tell tell) const {
    for (const Senders& senders : senders_)
      if (senders.turns != 0) tell(*senders.topic, senders.turns);
  }

 private:
  struct Senders {
    const protocol::Topic* topic = nullptr;
    simulation::NodeId last;
    simulation::NodeId before;
    base::Time last_time{};
    base::Time before_time{};  // when `before` sent last
    std::uint64_t turns = 0;
  };

  client::FrameIndex index_;
  std::array<Senders, 256> senders_{};
};

}  // namespace ocm::sim
