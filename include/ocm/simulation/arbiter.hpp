/// A CAN bus in virtual time: who sends when, bit by bit, as a discrete-event simulation. The caller hands
/// time in; nothing here reads a clock, and the same calls give the same schedule.
///
///     Arbiter bus{500'000};
///     const NodeId board = bus.attach({QueueOrder::by_identifier, 3});
///     bus.send(board, frame, now);                                 // now: never earlier than before
///     bus.advance(now, [](const Delivery& d) { ... });             // at next_event(), or when it pleases
///
/// Host side: memory is taken in `attach` only. A frame costs O(nodes), plus O(queue) for each node that
/// queues by identifier, plus one pass over its bits. Not thread-safe.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/can/length.hpp"
#include "ocm/simulation/bit_clock.hpp"

namespace ocm::simulation {

/// Which of its waiting frames a node offers to the bus.
enum class QueueOrder : std::uint8_t {
  fifo,           ///< the oldest: a socket of a host, a controller with a transmit FIFO
  by_identifier,  ///< the one that wins the arbitration; of equals the oldest: mailboxes
};

struct NodeOptions {
  QueueOrder order = QueueOrder::fifo;
  std::size_t capacity = 64;  ///< frames that may wait, at least 1
};

/// A node of one Arbiter. Never given twice: that of a node which has left stays invalid.
struct NodeId {
  std::uint32_t index = 0;
  std::uint32_t generation = 0;  ///< 0: no node
  friend constexpr bool operator==(const NodeId&, const NodeId&) = default;
};

/// A frame that was sent. Boundaries count bits from the bus's epoch.
struct Delivery {
  can::Frame frame{};
  NodeId from{};            ///< may have left meanwhile
  std::uint64_t start = 0;  ///< boundary at which its start of frame began
  std::uint64_t end = 0;    ///< boundary at which the last bit of its end of frame was over
  base::Time time{};        ///< of `end`: receivers have the frame now
};

struct NodeCounters {
  std::uint64_t sent = 0;     ///< frames complete on the bus
  std::uint64_t refused = 0;  ///< frames that the full queue did not take
};

struct BusTotals {
  std::uint64_t frames = 0;
  std::uint64_t busy_bits =
      0;                      ///< bits of complete frames, each with its intermission: all of them is load 1
  std::uint64_t refused = 0;  ///< by a full queue, nodes that have left included
  std::uint64_t withdrawn = 0;  ///< waiting frames of nodes that left with Leftovers::withdraw
  std::uint64_t clashes = 0;    ///< arbitrations in which two nodes offered the same identifier and format
};

/// What becomes of the frames that still wait when a node leaves.
enum class Leftovers : std::uint8_t { send, withdraw };

/// The rules, as ISO 11898-1 has them where it matters for time:
/// - On an idle bus a frame starts at the first bit boundary at or after its hand-over; all that was handed
///   over by then takes part in the arbitration.
/// - The lowest can::arbitration_key wins. The losers try again after the winner.
/// - A frame takes can::frame_bits, with the stuff bits of its content; then three bits of intermission. The
///   next start of frame is at once after that: a controller may answer a frame without idle time between.
/// - Nothing goes wrong on the wire: every frame is acknowledged, even when nobody else is attached.
/// - Two nodes that offer the same key would both believe to have won, and a bit error would follow at the
///   first different bit. Here the node with the lower index sends first, and it is counted as a clash.
class Arbiter {
 public:
  /// `bit_rate`: 1 to 1'000'000'000 bit/s. Boundary 0 is at `epoch`.
  explicit Arbiter(std::uint32_t bit_rate = 500'000, base::Time epoch = {})
      : clock_(bit_rate, epoch), now_(epoch) {}

  /// A new node, with an empty queue. Takes memory for the whole queue, 32 bytes a frame.
  [[nodiscard]] NodeId attach(NodeOptions options = {}) {
    auto place = std::find_if(nodes_.begin(), nodes_.end(), [](const Node& node) { return !node.attached; });
    if (place == nodes_.end()) place = nodes_.insert(place, Node{});
    const std::uint32_t generation = place->generation;
    *place = Node{};
    place->generation = generation + 1;
    place->attached = true;
    place->order = options.order;
    place->ring.resize(std::max<std::size_t>(options.capacity, 1));
    return {static_cast<std::uint32_t>(place - nodes_.begin()), place->generation};
  }

  /// The node takes no more frames. One that is on the bus is completed; those that wait are sent all the
  /// same, or withdrawn. Advance to the present first: a frame that has not started yet still waits. Returns
  /// the number of frames withdrawn; 0 for a node that has left before.
  std::size_t detach(NodeId id, Leftovers leftovers) noexcept {
    Node* const node = find(id);
    if (node == nullptr || node->leaving) return 0;
    node->leaving = true;
    const std::size_t withdrawn = leftovers == Leftovers::withdraw ? node->size : 0;
    if (withdrawn != 0) {
      node->size = 0;
      next_.reset();
    }
    totals_.withdrawn += withdrawn;
    if (node->size == 0) release(*node);
    return withdrawn;
  }

  /// Hands a frame over at `at`; a time before that of the last `advance` is taken as that one. true: taken;
  /// false: the queue is full, counted (advance to `at` before: frames leave the queue only then);
  /// Error::closed: the node has left; Error::bad_identifier, Error::bad_length: no such frame on a bus.
  base::Result<bool> send(NodeId id, const can::Frame& frame, base::Time at) noexcept {
    if (frame.format == can::Format::error) return base::Error::bad_identifier;
    if (const auto valid = can::validate(frame); !valid) return valid.error;
    Node* const node = find(id);
    if (node == nullptr || node->leaving) return base::Error::closed;
    if (node->size == node->ring.size()) {
      ++node->counters.refused;
      ++totals_.refused;
      return false;
    }
    node->push({frame, can::arbitration_key(frame), clock_.boundary_from(std::max(at, now_))});
    if (!on_bus_) next_.reset();
    return true;
  }
  /// At the present time.
  base::Result<bool> send(NodeId id, const can::Frame& frame) noexcept { return send(id, frame, now_); }

  /// Lets time pass until `now` and calls `deliver(const Delivery&)` for every frame that is complete by
  /// then, in order; now() is that frame's time meanwhile. `deliver` may send, attach and detach, so that an
  /// answer takes part in the very next arbitration, but not advance. A time in the past changes nothing.
  template <class Deliver>
  void advance(base::Time now, Deliver&& deliver) {
    for (;;) {
      if (!on_bus_) {
        // Up to the boundary itself somebody may hand over a frame that wins.
        if (!choose() || clock_.time_of(next_->start) >= now) break;
        start();
      }
      if (clock_.time_of(next_->end) > now) break;
      const Delivery delivery = complete();
      now_ = std::max(now_, delivery.time);
      deliver(delivery);
    }
    now_ = std::max(now_, now);
  }

  /// When the next frame will be complete, as things stand: a `send` can change it. base::never when none
  /// waits.
  [[nodiscard]] base::Time next_event() const noexcept {
    return on_bus_ || choose() ? clock_.time_of(next_->end) : base::never;
  }

  /// The latest time handed to `advance`, or that of the frame being delivered.
  [[nodiscard]] base::Time now() const noexcept { return now_; }
  [[nodiscard]] const BitClock& clock() const noexcept { return clock_; }
  [[nodiscard]] const BusTotals& totals() const noexcept { return totals_; }
  /// Zeros for a node that has left.
  [[nodiscard]] NodeCounters counters(NodeId id) const noexcept {
    const Node* const node = find(id);
    return node == nullptr ? NodeCounters{} : node->counters;
  }
  /// Frames that wait; the one on the bus does not.
  [[nodiscard]] std::size_t waiting(NodeId id) const noexcept {
    const Node* const node = find(id);
    return node == nullptr ? 0 : node->size;
  }
  /// Frames that the queue still takes.
  [[nodiscard]] std::size_t room(NodeId id) const noexcept {
    const Node* const node = find(id);
    return node == nullptr || node->leaving ? 0 : node->ring.size() - node->size;
  }

 private:
  struct Waiting {
    can::Frame frame{};
    std::uint32_t key = 0;
    std::uint64_t ready = 0;  ///< first boundary at which it may start
  };

  struct Node {
    std::vector<Waiting> ring;  ///< in order of hand-over
    std::size_t head = 0;
    std::size_t size = 0;
    NodeCounters counters;
    std::uint32_t generation = 0;
    QueueOrder order = QueueOrder::fifo;
    bool attached = false;
    bool leaving = false;

    [[nodiscard]] std::size_t place(std::size_t i) const noexcept {
      const std::size_t unwrapped = head + i;
      return unwrapped < ring.size() ? unwrapped : unwrapped - ring.size();
    }
    [[nodiscard]] const Waiting& operator[](std::size_t i) const noexcept { return ring[place(i)]; }
    void push(const Waiting& item) noexcept { ring[place(size++)] = item; }
    Waiting take(std::size_t i) noexcept {
      const Waiting item = (*this)[i];
      for (; i > 0; --i) ring[place(i)] = ring[place(i - 1)];
      head = place(1);
      --size;
      return item;
    }
    /// What the node offers at a start of frame: its position in the queue, or `size` for nothing.
    [[nodiscard]] std::size_t offer(std::uint64_t boundary) const noexcept {
      if (size == 0 || (*this)[0].ready > boundary) return size;
      std::size_t best = 0;
      if (order == QueueOrder::by_identifier)
        for (std::size_t i = 1; i < size && (*this)[i].ready <= boundary; ++i)
          if ((*this)[i].key < (*this)[best].key) best = i;
      return best;
    }
  };

  /// The frame that is on the bus or, while none is, the one that will be next as things stand.
  struct Next {
    can::Frame frame{};
    NodeId from{};
    std::size_t position = 0;  ///< in the queue of its node
    std::uint64_t start = 0;
    std::uint64_t end = 0;
    bool clash = false;
  };

  [[nodiscard]] const Node* find(NodeId id) const noexcept {
    if (id.index >= nodes_.size()) return nullptr;
    const Node& node = nodes_[id.index];
    return node.attached && node.generation == id.generation ? &node : nullptr;
  }
  [[nodiscard]] Node* find(NodeId id) noexcept {
    return const_cast<Node*>(static_cast<const Arbiter*>(this)->find(id));
  }

  void release(Node& node) noexcept {
    node.attached = false;
    node.ring = {};
  }

  /// Holds the next arbitration, without consequences yet. false: nobody has a frame.
  bool choose() const noexcept {
    if (next_) return true;
    std::uint64_t earliest = UINT64_MAX;
    for (const Node& node : nodes_)
      if (node.size != 0) earliest = std::min(earliest, node[0].ready);
    if (earliest == UINT64_MAX) return false;

    Next next;
    next.start = std::max(earliest, idle_from_);
    const Waiting* best = nullptr;
    for (std::size_t index = 0; index < nodes_.size(); ++index) {
      const Node& node = nodes_[index];
      const std::size_t position = node.offer(next.start);
      if (position == node.size) continue;
      const Waiting& offered = node[position];
      if (best != nullptr && offered.key >= best->key) {
        next.clash |= offered.key == best->key;
        continue;
      }
      best = &offered;
      next.position = position;
      next.from = {static_cast<std::uint32_t>(index), node.generation};
      next.clash = false;
    }
    next.frame = best->frame;
    next.end = next.start + can::frame_bits(best->frame);
    next_ = next;
    return true;
  }

  void start() noexcept {
    Node& node = nodes_[next_->from.index];
    node.take(next_->position);
    if (node.leaving && node.size == 0) release(node);
    if (next_->clash) ++totals_.clashes;
    on_bus_ = true;
  }

  Delivery complete() noexcept {
    const Delivery delivery{next_->frame, next_->from, next_->start, next_->end, clock_.time_of(next_->end)};
    next_.reset();
    on_bus_ = false;
    idle_from_ = delivery.end + can::intermission_bits;
    ++totals_.frames;
    totals_.busy_bits += idle_from_ - delivery.start;
    if (Node* const node = find(delivery.from)) ++node->counters.sent;
    return delivery;
  }

  BitClock clock_;
  base::Time now_;
  std::vector<Node> nodes_;
  mutable std::optional<Next> next_;  ///< a cache until `on_bus_`
  bool on_bus_ = false;
  std::uint64_t idle_from_ = 0;  ///< first boundary at which a frame may start
  BusTotals totals_;
};

/// A node as something to send to (can::Sender): what a simulated board takes for its CAN controller.
class Port {
 public:
  Port(Arbiter& bus, NodeOptions options) : bus_(&bus), node_(bus.attach(options)) {}
  base::Result<bool> send(const can::Frame& frame) noexcept { return bus_->send(node_, frame); }
  [[nodiscard]] NodeId node() const noexcept { return node_; }

 private:
  Arbiter* bus_;
  NodeId node_;
};

}  // namespace ocm::simulation
