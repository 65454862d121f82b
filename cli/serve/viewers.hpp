/// One producer and many viewers: each message is kept once, in one bounded queue, and each viewer reads the
/// queue at its own pace. A viewer that is slower than the queue is long jumps to what is there; what it has
/// lost is counted. It slows neither the producer nor other viewers. Knows no socket.
///
/// All may be called from any thread. O(1) for the producer, however many viewers there are.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ocm/base/time.hpp"

#include "cli/serve/foxglove.hpp"

namespace ocm::cli::serve {

/// How much the queue holds.
struct QueueLimits {
  std::size_t bytes = 8U << 20;
  std::size_t messages = 1U << 15;
};

/// A viewer, as long as it is there; a number is never given twice.
using ViewerId = std::uint64_t;

class Viewers {
 public:
  /// Of channels 0..channels-1.
  explicit Viewers(std::size_t channels, QueueLimits limits = {});

  // For the producer.

  /// Whether a viewer has subscribed to the channel: what has none need not be made.
  [[nodiscard]] bool wanted(std::uint32_t channel) const noexcept {
    return wanted_[channel].load(std::memory_order_relaxed) != 0;
  }
  /// Puts a message into the queue; nothing where it is not wanted.
  void publish(std::uint32_t channel, std::uint64_t time_ns, std::string payload);
  /// The same of what is a state: who subscribes later gets the newest at once.
  void publish_state(std::uint32_t channel, std::uint64_t time_ns, std::string payload);
  /// What came last, to a viewer that has subscribed to the channel since; nothing where more came since
  /// then.
  void give(ViewerId viewer, std::uint32_t channel, std::uint64_t time_ns, std::string payload);
  /// A text to one viewer, or with 0 to all; of a viewer that takes none, the oldest go.
  void tell(ViewerId viewer, std::string text);

  /// Of one for whom robots drive: it is asked whether it is there. `heard` counts what it says.
  void ask(ViewerId viewer);
  [[nodiscard]] std::uint64_t heard(ViewerId viewer) const;

  // For who sends.

  [[nodiscard]] ViewerId add();
  /// Texts that come before all others, those to all viewers included that were said meanwhile.
  void greet(ViewerId viewer, std::vector<std::string> texts);
  void remove(ViewerId viewer);
  [[nodiscard]] std::size_t count() const;
  /// The error says what is wrong: no such channel, or an id or a channel for the second time.
  [[nodiscard]] std::string subscribe(ViewerId viewer, foxglove::Subscription subscription);
  [[nodiscard]] std::string unsubscribe(ViewerId viewer, std::uint32_t subscription);

  struct Outgoing {
    bool binary = false;
    /// Of a binary message: what precedes the payload, which differs from viewer to viewer.
    foxglove::MessageHead head{};
    std::shared_ptr<const std::string> payload;
  };
  /// What the viewer is to be sent next; none: it has all. A status reports loss first, at most once
  /// a second of `now`, which is no clock that may be set.
  [[nodiscard]] std::optional<Outgoing> next(ViewerId viewer, base::Time now);
  /// Once for each `ask`: the viewer is to be pinged.
  [[nodiscard]] bool take_asked(ViewerId viewer);
  /// It has said something, or has answered.
  void hear(ViewerId viewer);
  /// Whether `next` may have something, or it is to be pinged.
  [[nodiscard]] bool has_next(ViewerId viewer) const;

  /// Whether `next` may have something for any viewer.
  [[nodiscard]] bool anything_waits() const;

  /// Messages that viewers have lost, those that have gone included.
  [[nodiscard]] std::uint64_t lost();
  /// Of one viewer.
  [[nodiscard]] std::uint64_t lost(ViewerId viewer);
  /// Bytes in the queue.
  [[nodiscard]] std::size_t size() const;

 private:
  using Payload = std::shared_ptr<const std::string>;
  struct Message {
    std::uint32_t channel = 0;
    std::uint64_t number = 0;  ///< of its channel, from 0: a gap is a loss
    std::uint64_t time_ns = 0;
    Payload payload;
  };
  struct Subscribed {
    std::uint32_t id = 0;
    std::uint64_t next = 0;   ///< number of the message that it is to get
    std::uint64_t first = 0;  ///< of the first one since it subscribed
  };
  struct Viewer {
    std::uint64_t cursor = 0;  ///< place in the queue, counted from the first message of all
    std::vector<std::optional<Subscribed>> by_channel;
    std::map<std::uint32_t, std::uint32_t> channels;  ///< by the subscription's id
    std::deque<Payload> texts;
    /// The newest of what it has just subscribed to, with the subscription.
    std::deque<std::pair<std::uint32_t, Outgoing>> states;
    std::uint64_t lost = 0;
    std::uint64_t told = 0;  ///< of these
    base::Time told_at{};
    bool asked = false;  ///< and not pinged yet
    std::uint64_t heard = 0;
  };

  [[nodiscard]] bool has_next(const Viewer& viewer) const;
  void put(std::uint32_t channel, std::uint64_t time_ns, Payload payload);
  void tell(Viewer& viewer, Payload text);
  std::optional<Outgoing> from_queue(Viewer& viewer);
  /// Where it has lost what it was not told.
  static std::optional<Outgoing> word_of_loss(Viewer& viewer, base::Time now);
  /// Of a viewer that the queue has left behind, counts what it has lost.
  void settle(Viewer& viewer);
  void settle(Viewer& viewer, std::uint32_t channel);

  QueueLimits limits_;
  std::vector<std::atomic<std::uint32_t>> wanted_;
  mutable std::mutex mutex_;
  std::deque<Message> queue_;
  std::uint64_t first_ = 0;  ///< place of queue_.front()
  std::size_t bytes_ = 0;
  std::vector<std::uint64_t> numbers_;          ///< of the next message of each channel
  std::vector<std::uint64_t> oldest_;           ///< of the first one that has not left the queue
  std::vector<std::optional<Message>> newest_;  ///< of channels that are states
  std::map<ViewerId, Viewer> viewers_;
  ViewerId last_id_ = 0;
  std::uint64_t lost_ = 0;
};

}  // namespace ocm::cli::serve
