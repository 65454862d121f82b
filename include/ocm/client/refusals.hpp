/// Whether a board refuses what this program has just asked of it or commanded. A board never confirms: what
/// it takes it does, and what it refuses it names on its refusal topic, unasked. So a program that wants to
/// know listens for a while after it has sent.
///
///     client::Refusals refusals{amiro::catalogue};
///     bus.send(frame); refusals.sent(frame, now);
///     while (now < refusals.listen_until()) ... if (const auto refused = refusals.take(received, now)) ...
///
/// A refusal (client/refusal_reader.hpp) names no program: one that another program earns within the same
/// while, for the same number, looks like this program's. While a refusal topic is published, a refusal comes
/// with its next sample only, perhaps after the while.
///
/// Pure: sends nothing, reads no clock. O(1) a frame.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "ocm/base/time.hpp"
#include "ocm/can/bus.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/client/frame_index.hpp"
#include "ocm/client/refusal_reader.hpp"
#include "ocm/client/sample.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::client {

class Refusals {
 public:
  /// The catalogue must outlive it.
  explicit Refusals(const protocol::Catalogue& catalogue)
      : index_(catalogue), receiver_(catalogue), reader_(catalogue) {}

  /// A request or a set point was sent: its board may refuse it.
  void sent(const can::Frame& frame, base::Time now) {
    if (!repeated(frame, now)) return;
    listen_until_ = now + refusal_patience;
  }
  /// It was sent before, and was not refused: no reason to listen any longer. Whether there is a board that
  /// could refuse it.
  bool repeated(const can::Frame& frame, base::Time now) {
    if (refusal_topic(frame) == nullptr) return false;
    sent_[number(frame)] = now;
    return true;
  }
  /// Nothing to listen for after this.
  [[nodiscard]] base::Time listen_until() const noexcept { return listen_until_; }

  /// Where a refusal of this frame would come; nullptr: no board says so. A request to a refusal topic has
  /// none: its answer would look like a refusal.
  [[nodiscard]] const protocol::Topic* refusal_topic(const can::Frame& frame) const {
    const protocol::Topic* const topic = commanded(frame);
    if (topic == nullptr || topic->role == protocol::Role::refusal) return nullptr;
    return reader_.refusal_topic(topic->board);
  }

  /// Every frame from the bus, those before the first `sent` too: what was refused by then is old.
  [[nodiscard]] std::optional<Refused> take(const can::Received& received, base::Time now) {
    const Reception reception = receiver_.take(received);
    const auto refused = reader_.take(reception);
    if (!refused) return {};
    const auto& sent = sent_[refused->number];
    // Later than its deadline it is another program's.
    if (!sent || now - *sent > RefusalReader::longest_wait(*reception.topic)) return {};
    return refused;
  }

 private:
  [[nodiscard]] static std::uint8_t number(const can::Frame& frame) {
    return protocol::Identifier::decode(frame.id).topic.value;
  }
  /// The sensor or actuator that a frame commands.
  [[nodiscard]] const protocol::Topic* commanded(const can::Frame& frame) const {
    if (frame.format != can::Format::base) return nullptr;
    const auto id = protocol::Identifier::decode(frame.id);
    return id.direction == protocol::Direction::command ? index_.subject(id).topic : nullptr;
  }

  client::FrameIndex index_;
  Receiver receiver_;
  RefusalReader reader_;
  std::array<std::optional<base::Time>, 256> sent_{};  // by number
  base::Time listen_until_ = base::Time::min();
};

}  // namespace ocm::client
