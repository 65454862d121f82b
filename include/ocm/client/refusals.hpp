/// Whether a board refuses what this program has just asked of it or commanded. A board never confirms: what
/// it takes it does, and what it refuses it names on its refusal topic, unasked. So a program that wants to
/// know listens for a while after it has sent.
///
///     client::Refusals refusals{amiro::catalogue};
///     bus.send(frame); refusals.sent(frame, now);
///     while (now < refusals.listen_until()) ... if (const auto refused = refusals.take(received, now)) ...
///
/// A refusal names the number that it is for and a reason, but not who has asked: one that another program
/// earns within the same while, for the same number, looks like this program's. Several in a row come as one,
/// the last. While a refusal topic is published, a refusal comes with its next sample only, perhaps
/// after the while.
///
/// Pure: sends nothing, reads no clock. O(1) a frame.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/can/bus.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/client/diagnosis.hpp"
#include "ocm/client/frame_index.hpp"
#include "ocm/client/sample.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::client {

/// How long to listen for a refusal. [decided: at 100 kbit/s, a fifth of the AMiRo's rate, the refusal, which
/// is the least urgent of all messages, takes at most 29 ms, and the request no more (`amiroctl analyse bus
/// --bitrate 100k`); what is left is for the board and for this machine. At 500 kbit/s each takes at most 7
/// ms.]
inline constexpr base::Duration refusal_patience{100'000'000};

/// What a board refused.
struct Refused {
  const protocol::Topic* topic = nullptr;  ///< that was asked or commanded
  std::string_view board;
  std::string_view reason;  ///< by the spec's name; empty: a number without one
};

class Refusals {
 public:
  /// The catalogue must outlive it.
  explicit Refusals(const protocol::Catalogue& catalogue)
      : catalogue_(&catalogue), index_(catalogue), receiver_(catalogue), diagnosis_(catalogue) {
    known_.resize(catalogue.boards.size());
  }

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
    return topic->board < known_.size() ? diagnosis_.boards()[topic->board].refusal : nullptr;
  }

  /// Every frame from the bus, those before the first `sent` too: what was refused by then is old.
  [[nodiscard]] std::optional<Refused> take(const can::Received& received, base::Time now) {
    const Reception reception = receiver_.take(received);
    diagnosis_.take(reception);
    if (reception.meaning != Meaning::sample || reception.topic->role != protocol::Role::refusal) return {};
    const std::size_t index = reception.topic->board;
    const BoardReport& board = diagnosis_.boards()[index];
    const bool is_old = known_[index] == board.refused;
    known_[index] = board.refused;
    const auto& sent = sent_[static_cast<std::uint8_t>(board.refused_topic)];
    // Later than its deadline it is another program's.
    if (is_old || !sent || now - *sent > reception.topic->deadline + refusal_patience) return {};
    const protocol::Topic* const topic = refused_topic(board.refused_topic, index);
    if (topic == nullptr) return {};
    return Refused{topic, catalogue_->boards[index].name, board.reason};
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
  [[nodiscard]] const protocol::Topic* refused_topic(std::int64_t number, std::size_t board) const {
    const protocol::Identifier id{
        protocol::Direction::command, {}, protocol::TopicId{static_cast<std::uint8_t>(number)}};
    const protocol::Topic* const topic = index_.subject(id).topic;
    return topic != nullptr && topic->board == board ? topic : nullptr;
  }

  const protocol::Catalogue* catalogue_;
  client::FrameIndex index_;
  Receiver receiver_;
  Diagnosis diagnosis_;
  std::vector<std::optional<std::int64_t>> known_;     // how many each board has refused, as it said last
  std::array<std::optional<base::Time>, 256> sent_{};  // by number
  base::Time listen_until_ = base::Time::min();
};

}  // namespace ocm::client
