/// A CAN bus in virtual time: who sends when, bit by bit, as a discrete-event simulation. The caller hands
/// time in; nothing here reads a clock, and the same calls give the same schedule.
///
///     Arbiter bus{500'000};
///     const NodeId board = bus.attach({QueueOrder::by_identifier, 3});
///     bus.send(board, frame, now);                                 // now: never earlier than before
///     bus.advance(now, [](const Delivery& d) { ... });             // at next_event(), or when it pleases
///
/// The wire can be disturbed: `bus.disturb({.boundary = 42})`. Without that nothing ever goes wrong.
///
/// Host side: memory is taken in `attach` and `disturb` only. A frame costs O(nodes), plus O(queue) for each
/// node that queues by identifier, plus one pass over its bits. Not thread-safe.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/any_frame.hpp"
#include "ocm/can/fd_bits.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/can/length.hpp"
#include "ocm/simulation/bit_clock.hpp"
#include "ocm/simulation/disturbance.hpp"
#include "ocm/simulation/fault_confinement.hpp"
#include "ocm/simulation/fd_store.hpp"
#include "ocm/simulation/transmit_queue.hpp"

namespace ocm::simulation {

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

/// A frame that was sent. Boundaries count from the bus's epoch.
struct Delivery {
  can::Frame frame{};                 ///< of a CAN FD frame the identifier alone
  NodeId from{};                      ///< may have left meanwhile
  std::uint64_t start = 0;            ///< boundary at which its start of frame began
  std::uint64_t end = 0;              ///< boundary at which the last bit of its end of frame was over
  base::Time time{};                  ///< of `end`: receivers have the frame now
  bool sent = true;                   ///< false: its sender saw an error in the last bit and will repeat it
  const can::AnyFrame* fd = nullptr;  ///< a CAN FD frame, valid until the next delivery; null: a classic one
};

/// An error frame. Overload frames are none.
struct BusError {
  NodeId sender{};    ///< whose frame was disturbed; none: no frame was under way
  base::Time time{};  ///< when the disturbed bit was over
};

struct NodeCounters {
  std::uint64_t sent = 0;     ///< frames complete on the bus
  std::uint64_t refused = 0;  ///< frames that the full queue did not take
  std::uint64_t broken = 0;   ///< times that a frame of it was disturbed
};

/// Bits: those of the bus's clock, as boundaries.
struct BusTotals {
  std::uint64_t frames = 0;
  std::uint64_t busy_bits = 0;    ///< of complete frames, each with its intermission: all of them is load 1
  std::uint64_t refused = 0;      ///< by a full queue, nodes that have left included
  std::uint64_t withdrawn = 0;    ///< waiting frames of nodes that left with Leftovers::withdraw
  std::uint64_t clashes = 0;      ///< arbitrations in which two nodes offered the same identifier and format
  std::uint64_t errors = 0;       ///< error frames
  std::uint64_t overloads = 0;    ///< overload frames
  std::uint64_t repetitions = 0;  ///< disturbed frames that took part in the arbitration again
  std::uint64_t duplicates = 0;   ///< frames that receivers got and will get again
  std::uint64_t error_bits = 0;   ///< bits of disturbed frames, error and overload frames, each with its
                                  ///< intermission; none of them in `busy_bits`
};

/// What becomes of the frames that still wait when a node leaves.
enum class Leftovers : std::uint8_t { send, withdraw };

/// The rules, as ISO 11898-1 has them where it matters for time:
/// - On an idle bus a frame starts at the first bit boundary at or after its hand-over; all that was handed
///   over by then takes part in the arbitration.
/// - The lowest can::arbitration_key wins. The losers try again after the winner.
/// - A frame takes can::frame_bits, with the stuff bits of its content; then three bits of intermission. A
/// CAN
///   FD frame takes can::fd_frame_bits, each part at its bit rate. The next start of frame is at once after
///   that: a controller may answer a frame without idle time between.
/// - Every frame is acknowledged, even when no other node is attached. Every node knows CAN FD, or bears it.
/// - Two nodes that offer the same key would both believe to have won, and a bit error would follow at the
///   first different bit. Here the node with the lower index sends first, and it is counted as a clash.
///
/// And where the wire is disturbed (disturbance.hpp):
/// - In a frame: the error flags begin with the next bit, then 8 bits of delimiter and the intermission. The
///   frame waits again where it waited before, and takes part in the next arbitration.
/// - In the last bit of a frame: receivers have accepted it already, its sender repeats it all the same. It
///   is delivered with `sent` false, later once more, and counted in `duplicates`.
/// - In an error frame, up to the last bit of its delimiter: another error frame, which ends no earlier.
/// - In the first two bits of the intermission: an overload frame, which is as long.
/// - In the third one, or on an idle bus: a dominant bit there is a start of frame. A node with a frame to
///   send goes on from it; when there is none, six recessive bits follow, a stuff error, and an error frame.
/// - Each error frame counts in every node's FaultConfinement. An error passive node waits 8 bits more before
///   it follows a frame of its own. One that is bus-off keeps its frames, and sends them when 128 times 11
///   recessive bits have passed: the end of each frame, and of each error frame, has one such sequence.
///   Deliveries are not for it, which is for the caller to heed.
///
/// Boundaries are those of the shortest bits, of which each other bit has `data_factor`: without CAN FD, or
/// where it has the same bit rate, a boundary is one of every bit. The grid of a frame's bits begins again at
/// the end of the frame before it, as nodes synchronise to each start of frame. A disturbance lasts a bit of
/// the arbitration, wherever it falls.
class Arbiter {
 public:
  /// `bit_rate`: 1 to 1'000'000'000 bit/s. Boundary 0 is at `epoch`. `data_factor`: how many times faster the
  /// data of CAN FD frames with bit-rate switch are, at least 1; times `bit_rate` 1'000'000'000 at most.
  explicit Arbiter(std::uint32_t bit_rate = 500'000, base::Time epoch = {}, std::uint32_t data_factor = 1)
      : clock_(bit_rate * data_factor, epoch), now_(epoch), bit_(data_factor) {}

  /// A new node, with an empty queue. Takes memory for the whole queue, 32 bytes a frame.
  [[nodiscard]] NodeId attach(NodeOptions options = {}) {
    auto place = std::find_if(nodes_.begin(), nodes_.end(), [](const Node& node) { return !node.attached; });
    if (place == nodes_.end()) place = nodes_.insert(place, Node{});
    const std::uint32_t generation = place->generation;
    *place = Node{};
    place->generation = generation + 1;
    place->attached = true;
    place->queue = TransmitQueue{options.order, options.capacity};
    return {static_cast<std::uint32_t>(place - nodes_.begin()), place->generation};
  }

  /// The node takes no more frames. One that is on the bus is completed; those that wait are sent all the
  /// same, or withdrawn, as is the one on the bus if it is disturbed then. Advance to the present first: a
  /// frame that has not started yet still waits. Returns the number of waiting frames withdrawn; 0 for a node
  /// that has left before.
  std::size_t detach(NodeId id, Leftovers leftovers) noexcept {
    Node* const node = find(id);
    if (node == nullptr || node->leaving) return 0;
    node->leaving = true;
    node->repeats = leftovers == Leftovers::send;
    const std::size_t withdrawn = node->repeats ? 0 : node->queue.size();
    if (withdrawn != 0) {
      for (std::size_t i = 0; i < withdrawn; ++i) fd_.release(node->queue[i].fd);
      node->queue.clear();
      if (!on_bus_) next_.reset();
    }
    totals_.withdrawn += withdrawn;
    release_if_done(*node);
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
    if (node->queue.room() == 0) {
      ++node->counters.refused;
      ++totals_.refused;
      return false;
    }
    node->queue.push({frame, can::arbitration_key(frame), 0, clock_.boundary_from(std::max(at, now_))});
    if (!on_bus_) next_.reset();
    return true;
  }
  /// A frame of either kind. Memory is taken for CAN FD frames that wait, and kept.
  base::Result<bool> send_any(NodeId id, const can::AnyFrame& frame, base::Time at) {
    if (const auto classic = frame.classic()) return send(id, *classic, at);
    if (const auto valid = can::validate(frame); !valid) return valid.error;
    const can::Frame head{.id = frame.id, .format = frame.format};
    const auto taken = send(id, head, at);  // the frame is the last of its queue now
    if (taken && *taken) find(id)->queue.newest().fd = fd_.keep(frame);
    return taken;
  }
  /// At the present time.
  base::Result<bool> send(NodeId id, const can::Frame& frame) noexcept { return send(id, frame, now_); }

  /// One bit will be seen wrong. A boundary of the past is taken as the next one.
  void disturb(Disturbance disturbance) {
    disturbance.boundary = std::max(disturbance.boundary, clock_.boundary_from(now_));
    disturbances_.push(disturbance);
  }

  /// Lets time pass until `now` and calls `deliver(const Delivery&)` for every frame that is complete by
  /// then, in order; now() is that frame's time meanwhile. `deliver` may send, attach and detach, so that an
  /// answer takes part in the very next arbitration, but not advance. A time in the past changes nothing.
  /// `complain(const BusError&)` is called for every error frame that begins by then.
  template <class Deliver, class Complain>
  void advance(base::Time now, Deliver&& deliver, Complain&& complain) {
    for (;;) {
      const std::uint64_t next = on_bus_ ? next_->end : choose() ? next_->start : UINT64_MAX;
      if (disturbances_.any_before(next)) {
        if (clock_.time_of(disturbances_.front().boundary + bit_) > now) break;
        disturb_now(deliver, complain);
      } else if (on_bus_) {
        if (clock_.time_of(next) > now) break;
        hand_out(complete(), deliver);
      } else {
        // Up to the boundary itself a node may hand over a frame that wins.
        if (next == UINT64_MAX || clock_.time_of(next) >= now) break;
        end_silence(next);
        start();
      }
    }
    now_ = std::max(now_, now);
  }
  template <class Deliver>
  void advance(base::Time now, Deliver&& deliver) {
    advance(now, deliver, [](const BusError&) {});
  }

  /// When the next frame will be complete, or the next disturbance over, as things stand: a `send` can change
  /// it. base::never when nothing lies ahead.
  [[nodiscard]] base::Time next_event() const noexcept {
    const std::uint64_t end = on_bus_ || choose() ? next_->end : UINT64_MAX;
    if (disturbances_.any_before(end)) return clock_.time_of(disturbances_.front().boundary + bit_);
    return end == UINT64_MAX ? base::never : clock_.time_of(end);
  }

  /// The latest time handed to `advance`, or that of the frame being delivered.
  [[nodiscard]] base::Time now() const noexcept { return now_; }
  [[nodiscard]] const BitClock& clock() const noexcept { return clock_; }
  /// Boundaries of its clock in a bit of the arbitration.
  [[nodiscard]] std::uint32_t data_factor() const noexcept { return static_cast<std::uint32_t>(bit_); }
  [[nodiscard]] const BusTotals& totals() const noexcept { return totals_; }
  /// Zeros for a node that has left.
  [[nodiscard]] NodeCounters counters(NodeId id) const noexcept {
    const Node* const node = find(id);
    return node == nullptr ? NodeCounters{} : node->counters;
  }
  /// Its error counters at now(). All clean for a node that has left.
  [[nodiscard]] FaultConfinement faults(NodeId id) const noexcept {
    const Node* const node = find(id);
    if (node == nullptr) return {};
    FaultConfinement faults = node->faults;
    std::uint64_t present = clock_.boundary_from(now_);
    if (clock_.time_of(present) > now_) --present;
    if (!on_bus_) faults.saw_recessive(sequences_until(present));
    return faults;
  }
  /// Frames that wait; the one on the bus does not.
  [[nodiscard]] std::size_t waiting(NodeId id) const noexcept {
    const Node* const node = find(id);
    return node == nullptr ? 0 : node->queue.size();
  }
  /// Frames that the queue still takes.
  [[nodiscard]] std::size_t room(NodeId id) const noexcept {
    const Node* const node = find(id);
    return node == nullptr || node->leaving ? 0 : node->queue.room();
  }

 private:
  struct Node {
    TransmitQueue queue;
    NodeCounters counters;
    FaultConfinement faults;
    std::uint64_t barred_until = 0;  ///< error passive or bus-off: no start of frame before
    std::uint32_t generation = 0;
    bool attached = false;
    bool leaving = false;
    bool repeats = true;  ///< what is disturbed; only a node that leaves may not

    [[nodiscard]] std::uint64_t earliest() const noexcept { return std::max(queue.earliest(), barred_until); }
    /// Its position in the queue, or the queue's size for nothing.
    [[nodiscard]] std::size_t offer(std::uint64_t boundary) const noexcept {
      return barred_until > boundary ? queue.size() : queue.offer(boundary);
    }
  };

  /// The frame that is on the bus or, while none is, the one that will be next as things stand.
  struct Next {
    WaitingFrame item{};
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

  /// The place of a node that leaves is free when nothing of it waits or is on the bus.
  void release_if_done(Node& node) noexcept {
    if (!node.leaving || !node.queue.empty()) return;
    if (on_bus_ && find(next_->from) == &node) return;
    node.attached = false;
    node.queue = {};
  }

  // --- frames ---

  /// Holds the next arbitration, without consequences yet. false: no node has a frame.
  bool choose() const noexcept {
    if (next_) return true;
    std::uint64_t earliest = UINT64_MAX;
    for (const Node& node : nodes_)
      if (!node.queue.empty()) earliest = std::min(earliest, node.earliest());
    if (earliest == UINT64_MAX) return false;

    Next next;
    next.start = std::max(earliest, idle_from_);
    if (bit_ != 1) next.start += (bit_ - (next.start - idle_from_) % bit_) % bit_;  // on the grid of bits
    const WaitingFrame* best = nullptr;
    for (std::size_t index = 0; index < nodes_.size(); ++index) {
      const Node& node = nodes_[index];
      const std::size_t position = node.offer(next.start);
      if (position == node.queue.size()) continue;
      const WaitingFrame& offered = node.queue[position];
      if (best != nullptr && offered.key >= best->key) {
        next.clash |= offered.key == best->key;
        continue;
      }
      best = &offered;
      next.position = position;
      next.from = {static_cast<std::uint32_t>(index), node.generation};
      next.clash = false;
    }
    next.item = *best;
    next.end = next.start + length(*best);
    next_ = next;
    return true;
  }

  [[nodiscard]] std::uint64_t length(const WaitingFrame& item) const noexcept {
    if (item.fd == 0) return bit_ * can::frame_bits(item.frame);
    const can::FdBits bits = can::fd_frame_bits(fd_[item.fd]);
    return bit_ * bits.nominal + bits.data;
  }

  /// The silence before it has ended.
  void start() noexcept {
    last_sender_ = next_->from;
    nodes_[next_->from.index].queue.take(next_->position);
    if (next_->clash) ++totals_.clashes;
    on_bus_ = true;
  }

  Delivery complete() noexcept {
    const std::uint32_t fd = next_->item.fd;
    const Delivery delivery = taken_off();
    fd_.release(fd);
    ++totals_.frames;
    Node& sender = nodes_[delivery.from.index];
    ++sender.counters.sent;
    if (faults_) {
      for (Node& node : nodes_) &node == &sender ? node.faults.sent() : node.faults.received();
    }
    begin_silence(delivery.start, delivery.end + bit_ * can::intermission_bits, totals_.busy_bits);
    release_if_done(sender);
    return delivery;
  }

  /// The frame under way is on the bus no more.
  Delivery taken_off() noexcept {
    Delivery delivery{next_->item.frame, next_->from, next_->start, next_->end, clock_.time_of(next_->end)};
    if (next_->item.fd != 0) {
      delivered_ = fd_[next_->item.fd];
      delivery.fd = &delivered_;
    }
    next_.reset();
    on_bus_ = false;
    return delivery;
  }

  template <class Deliver>
  void hand_out(const Delivery& delivery, Deliver& deliver) {
    now_ = std::max(now_, delivery.time);
    deliver(delivery);
  }

  // --- disturbances ---

  template <class Deliver, class Complain>
  void disturb_now(Deliver& deliver, Complain& complain) {
    const Disturbance disturbance = disturbances_.pop();
    const BusError error{on_bus_ ? next_->from : NodeId{}, clock_.time_of(disturbance.boundary + bit_)};
    const std::uint64_t errors = totals_.errors;
    std::optional<Delivery> received;
    if (on_bus_)
      received = break_frame(disturbance);
    else
      disturb_silence(disturbance);
    if (received) hand_out(*received, deliver);  // it was complete before the error was seen
    now_ = std::max(now_, error.time);
    if (totals_.errors != errors) complain(error);
  }

  /// The frame under way is disturbed. Returns what receivers have got in spite of it.
  std::optional<Delivery> break_frame(const Disturbance& disturbance) noexcept {
    const WaitingFrame item = next_->item;
    const std::size_t position = next_->position;
    Delivery delivery = taken_off();
    Node& sender = nodes_[delivery.from.index];
    ++sender.counters.broken;
    if (sender.repeats) {
      sender.queue.put_back(position, item);
      ++totals_.repetitions;
    } else {
      fd_.release(item.fd);
      ++totals_.withdrawn;
    }
    count_error();
    begin_silence(delivery.start, disturbance.over(bit_), totals_.error_bits);
    release_if_done(sender);
    if (disturbance.boundary + bit_ < delivery.end) return std::nullopt;
    delivery.sent = false;
    if (sender.repeats) ++totals_.duplicates;
    return delivery;
  }

  /// A disturbance while no frame is under way.
  void disturb_silence(Disturbance disturbance) noexcept {
    const std::uint64_t boundary = disturbance.boundary;
    end_silence(boundary);
    if (boundary + bit_ * can::intermission_bits < idle_from_) {  // in an error frame
      count_error();
    } else if (boundary + bit_ < idle_from_) {
      ++totals_.overloads;
    } else {
      if (can_start_at(boundary)) return start();
      last_sender_ = {};
      disturbance.boundary += bit_ * stuff_error_bits;
      count_error();
    }
    begin_silence(boundary, disturbance.over(bit_), totals_.error_bits);
    next_.reset();
  }

  /// Whether a frame waits that can go on from a start of frame there, which is so in the last bit of an
  /// intermission only; if so, it is the next one.
  bool can_start_at(std::uint64_t boundary) noexcept {
    const std::uint64_t idle_from = std::exchange(idle_from_, boundary);
    next_.reset();
    if (choose() && next_->start == boundary) return true;
    next_.reset();
    idle_from_ = idle_from;
    return false;
  }

  /// An error frame: a failure of the last sender, if any, and of all listeners.
  void count_error() noexcept {
    ++totals_.errors;
    faults_ = true;
    const Node* const sender = find(last_sender_);
    for (Node& node : nodes_)
      &node == sender ? node.faults.failed_to_send() : node.faults.failed_to_receive();
  }

  // --- silence: what lies between what is sent ---

  /// Whatever was sent from `from` on is over, its intermission at `until`.
  void begin_silence(std::uint64_t from, std::uint64_t until, std::uint64_t& bits) noexcept {
    idle_from_ = std::max(idle_from_, until);
    bits += idle_from_ - std::max(from, counted_until_);
    counted_until_ = idle_from_;
    if (!faults_) return;
    faults_ = false;
    const Node* const sender = find(last_sender_);
    for (Node& node : nodes_) {
      node.barred_until = barred_until(node, &node == sender);
      faults_ = faults_ || !node.faults.clean();
    }
  }

  [[nodiscard]] std::uint64_t barred_until(const Node& node, bool sent_last) const noexcept {
    switch (node.faults.state()) {
      case FaultState::bus_off:  // the first sequence ends with the intermission
        return idle_from_ +
               std::uint64_t{node.faults.sequences_left() - 1} * FaultConfinement::sequence_bits * bit_;
      case FaultState::error_passive:
        return sent_last ? idle_from_ + FaultConfinement::suspend_bits * bit_ : 0;
      case FaultState::error_active:
        break;
    }
    return 0;
  }

  /// Something begins at `boundary`: nodes that are bus-off have seen what there was to see.
  void end_silence(std::uint64_t boundary) noexcept {
    if (!faults_) return;
    for (Node& node : nodes_) node.faults.saw_recessive(sequences_until(boundary));
  }

  /// Sequences of 11 recessive bits since something was sent. The first is the end of that, from its last
  /// delimiter on, with the intermission.
  [[nodiscard]] std::uint64_t sequences_until(std::uint64_t boundary) const noexcept {
    return boundary < idle_from_ ? 0 : 1 + (boundary - idle_from_) / (FaultConfinement::sequence_bits * bit_);
  }

  BitClock clock_;
  base::Time now_;
  std::uint64_t bit_;  ///< boundaries in a bit of the arbitration
  std::vector<Node> nodes_;
  FdStore fd_;
  can::AnyFrame delivered_;           ///< the last CAN FD frame that was
  mutable std::optional<Next> next_;  ///< a cache until `on_bus_`
  bool on_bus_ = false;
  bool faults_ = false;          ///< some node's counters are not clean
  std::uint64_t idle_from_ = 0;  ///< first boundary at which a frame may start
  std::uint64_t counted_until_ = 0;
  NodeId last_sender_{};
  Disturbances disturbances_;
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
