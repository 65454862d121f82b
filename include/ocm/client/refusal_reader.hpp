/// What boards refuse, read from their refusal topics, each refusal once: one that is published again, with
/// the same count, is old.
///
/// A refusal names the number that it is for and a reason, but not who has asked. Several in a row come as
/// one, the last; its count says how many there were. While a refusal topic is published, a refusal comes
/// with its next sample only.
///
/// Pure: sends nothing, reads no clock. O(1) a frame.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "ocm/base/time.hpp"
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
  const protocol::Topic* topic =
      nullptr;  ///< that was asked or commanded; of a sensor or actuator of the board
  std::string_view board;
  std::string_view reason;  ///< by the spec's name; empty: a number without one
  std::uint8_t number = 0;  ///< on the wire: which frame of an actuator
  std::uint32_t count =
      1;               ///< requests and set points that were refused since the refusal before, of any topic
  bool first = false;  ///< none of the board was heard before: it may be old
};

class RefusalReader {
 public:
  /// The catalogue must outlive it.
  explicit RefusalReader(const protocol::Catalogue& catalogue)
      : catalogue_(&catalogue), index_(catalogue), diagnosis_(catalogue) {
    known_.resize(catalogue.boards.size());
  }

  /// Where the refusals of a board come; nullptr: no board of this number, or it says none.
  [[nodiscard]] const protocol::Topic* refusal_topic(std::size_t board) const noexcept {
    return board < known_.size() ? diagnosis_.boards()[board].refusal : nullptr;
  }
  /// How long after a request its refusal may come, where that topic is published.
  [[nodiscard]] static base::Duration longest_wait(const protocol::Topic& refusal_topic) noexcept {
    return refusal_topic.deadline + refusal_patience;
  }

  /// Every reception, of whatever kind. Nothing: it is no refusal, an old one, or of a number that the board
  /// does not have.
  [[nodiscard]] std::optional<Refused> take(const Reception& reception) {
    if (reception.meaning != Meaning::sample) return {};
    const std::size_t index = reception.topic->board;
    if (reception.topic != refusal_topic(index)) return {};
    diagnosis_.take(reception);
    const BoardReport& board = diagnosis_.boards()[index];
    const auto before = std::exchange(known_[index], board.refused);
    if (before == board.refused) return {};
    const protocol::Topic* const topic = refused_topic(board.refused_topic, index);
    if (topic == nullptr) return {};
    // A board that has restarted counts from zero.
    const bool goes_on = before && *before < board.refused;
    const std::int64_t more = before ? board.refused - (goes_on ? *before : 0) : 1;
    return Refused{topic,
                   catalogue_->boards[index].name,
                   board.reason,
                   static_cast<std::uint8_t>(board.refused_topic),
                   static_cast<std::uint32_t>(std::max<std::int64_t>(more, 1)),
                   !before};
  }

 private:
  [[nodiscard]] const protocol::Topic* refused_topic(std::int64_t number, std::size_t board) const {
    const protocol::Identifier id{
        protocol::Direction::command, {}, protocol::TopicId{static_cast<std::uint8_t>(number)}};
    const protocol::Topic* const topic = index_.subject(id).topic;
    return topic != nullptr && topic->board == board ? topic : nullptr;
  }

  const protocol::Catalogue* catalogue_;
  client::FrameIndex index_;
  Diagnosis diagnosis_;
  std::vector<std::optional<std::int64_t>> known_;  // how many each board has refused, as it said last
};

}  // namespace ocm::client
