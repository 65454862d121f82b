/// Nodes whose queues do not offer the most urgent frame: FIFOs, and mailboxes that are too few to be taken
/// back. Bounds on response times, and on how long queues become. [Davis, Kollmann, Pollex, Slomka 2011,
/// "Controller Area Network (CAN) schedulability analysis with FIFO queues"; Davis, Navet 2012; Khan, Davis,
/// Navet 2011, "Schedulability analysis of CAN with non-abortable transmission requests"]
///
/// FIFO. Whatever is queued before m must go first, at the priority of whichever is the head. So m waits as
/// if its node's messages all had the priority of the lowest of them, L, for those that were queued before
/// it:
///
///     W(x) = B_L + sum over the node of ceil((x + J_j + tau_bit) / T_j) C_j - C_m
///          + sum over k < L of other nodes of ceil((W + J_k + f_k + tau_bit) / T_k) C_k
///     R    = max over x of J_m + W(x) - x + C_m
///
/// where x is when m is queued, from the start of the busy period on: at 0 or with one of its node's
/// messages. Deadlines beyond periods are allowed, unlike in the paper.
///
/// Mailboxes. A frame in a mailbox stays there; if less urgent ones of the node can fill all of them, one of
/// those must go before m can enter. While m waits, its node offers at least the highest of those in the
/// mailboxes, h; so m waits as if its priority were just below the lowest h that there can be.
///
/// To the rest of the bus a message that waits in its node arrives when it is offered: with jitter J + f,
/// f = R - J - C at most. Response times depend on each other's f, so all are computed again until none
/// changes. Sufficient, not exact: nothing is asked about which queues can be full at the same time.
///
/// Cost: O(n^2) a pass and few passes: for tools and tests, not for boards.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/analysis/checked.hpp"
#include "ocm/analysis/message_set.hpp"
#include "ocm/analysis/utilisation.hpp"
#include "ocm/analysis/verdict.hpp"

namespace ocm::analysis {

struct NodeQueue {
  enum class Kind : std::uint8_t {
    by_priority,  ///< offers the most urgent frame, always: as many mailboxes as messages, or aborts
    fifo,         ///< offers the oldest
    mailboxes,    ///< the queue is by priority; what has entered one of `mailboxes` stays until it is sent
  };
  Kind kind = Kind::by_priority;
  std::size_t mailboxes = 3;  ///< with the one that is on the bus, at least 1
};

/// How many frames of a message can wait or be sent at once, given its response time. 0: no bound.
[[nodiscard]] constexpr std::int64_t pending_bound(const Message& message, const Explained& result) noexcept {
  return result.bounded() ? ceil_div(result.response, message.period).value_or(0) : 0;
}

/// How many frames of a node can wait at once, the one on the bus included: what its queue must hold so that
/// none is lost. 0: no bound.
[[nodiscard]] constexpr std::int64_t queue_bound(std::span<const Message> set,
                                                 std::span<const Explained> results,
                                                 std::uint16_t node) noexcept {
  Checked sum = 0;
  for (std::size_t m = 0; m < set.size() && m < results.size(); ++m) {
    if (set[m].node != node) continue;
    const std::int64_t pending = pending_bound(set[m], results[m]);
    if (pending == 0) return 0;
    sum += pending;
  }
  return sum.value_or(0);
}

/// Analyses sets of up to N messages, `Message::node` of which is an index into the nodes.
template <std::size_t N>
class CanQueues {
 public:
  /// One result a message, valid until the next call. A set of more than N, an invalid number and a
  /// message of a node that is not there: bad_input throughout. `limits` are for each message, all passes
  /// together.
  constexpr std::span<const Explained> analyse(std::span<const Message> set, std::span<const NodeQueue> nodes,
                                               const CanBus& bus,
                                               Limits limits = {.terms = 200'000}) noexcept {
    set_ = set.first(std::min(set.size(), N));
    nodes_ = nodes;
    bus_ = bus;
    std::size_t bad = set.size() > N ? N : first_bad(set);
    for (std::size_t m = 0; m < set_.size() && bad == no_index; ++m)
      if (set_[m].node >= nodes.size() || nodes[set_[m].node].mailboxes < 1) bad = m;
    for (std::size_t m = 0; m < set_.size(); ++m) {
      results_[m] = {.deadline = set_[m].due(), .largest = bad};
      offered_[m] = set_[m].jitter;
      responses_[m] = 1;  // until something is known: one frame can wait
    }
    if (bad != no_index || !valid(bus)) return {results_.data(), set_.size()};
    left_ = (Checked{limits.terms} * static_cast<std::int64_t>(set_.size())).value_or(unbounded);
    for (int pass = 0; pass < most_passes; ++pass) {
      bool changed = false;
      for (std::size_t m = 0; m < set_.size(); ++m) results_[m] = respond(m);
      for (std::size_t m = 0; m < set_.size(); ++m) {
        changed = changed || results_[m].response != responses_[m];
        responses_[m] = results_[m].response;
        hand_on(m);
      }
      if (!changed) return {results_.data(), set_.size()};
    }
    // Before the last pass, nothing is a bound yet.
    for (std::size_t m = 0; m < set_.size(); ++m)
      results_[m] = {.deadline = set_[m].due(), .reason = Reason::too_long};
    return {results_.data(), set_.size()};
  }

 private:
  static constexpr int most_passes = 1'000;

  [[nodiscard]] constexpr const NodeQueue& queue(std::size_t m) const noexcept {
    return nodes_[set_[m].node];
  }

  /// How much later than planned the message can be offered to the bus.
  constexpr void hand_on(std::size_t m) noexcept {
    if (level_[m] == m && queue(m).kind != NodeQueue::Kind::fifo) return;
    const std::int64_t offered = responses_[m] == unbounded ? unbounded : responses_[m] - set_[m].cost;
    offered_[m] = std::max(offered_[m], offered);
  }

  /// The lowest priority at which the node may offer while m waits: m itself where nothing holds it up.
  [[nodiscard]] constexpr std::size_t offered_level(std::size_t m) const noexcept {
    const NodeQueue& own = queue(m);
    std::size_t level = m;
    Checked waiting = 0;
    for (std::size_t k = set_.size(); k-- > 0;) {
      if (set_[k].node != set_[m].node) continue;
      if (own.kind == NodeQueue::Kind::fifo) return k;
      if (own.kind == NodeQueue::Kind::by_priority || k <= m) break;
      // From the lowest up, until so many may fill all mailboxes: the last of them is the highest there.
      waiting += responses_[k] == unbounded ? Checked{static_cast<std::int64_t>(own.mailboxes)}
                                            : ceil_div(responses_[k], set_[k].period);
      if (!waiting.ok() || waiting.value() >= static_cast<std::int64_t>(own.mailboxes)) {
        level = k;
        break;
      }
    }
    return level;
  }

  constexpr Explained respond(std::size_t m) noexcept {
    level_[m] = offered_level(m);
    const std::size_t level = level_[m];
    const bool fifo = queue(m).kind == NodeQueue::Kind::fifo;
    Explained result{.deadline = set_[m].due(), .reason = Reason::too_long};
    longest_ = 0;
    Utilisation load;
    for (std::size_t k = 0; k <= level; ++k) {
      longest_ = std::max(longest_, set_[k].cost);
      load.add(set_[k].cost, set_[k].period);
    }
    if (bus_.errors.every > 0)
      load.add((Checked{error_frame_bits} * bus_.bit + longest_).value_or(unbounded), bus_.errors.every);
    for (std::size_t k = level + 1; k < set_.size(); ++k)
      if (set_[k].cost > result.blocking) {
        result.blocking = set_[k].cost;
        result.blocked_by = k;
      }
    const Comparison comparison = load.versus_one();
    if (comparison == Comparison::above ||
        (comparison == Comparison::equal && (result.blocking > 0 || bus_.errors.burst > 0))) {
      result.reason = Reason::overloaded;
      return result;
    }
    // The busy period of the level.
    std::int64_t busy = 1;
    if (!solve(busy, [&](std::int64_t t) {
          Checked sum = Checked{result.blocking} + error_delay(bus_, longest_, t);
          for (std::size_t k = 0; k <= level; ++k) sum += arrivals(k, t, 0) * set_[k].cost;
          return sum;
        }))
      return result;
    return fifo ? in_fifo(m, level, busy, result) : in_order(m, level, busy, result);
  }

  /// All that is offered at `level` or above goes before m, and all earlier instances of m.
  constexpr Explained in_order(std::size_t m, std::size_t level, std::int64_t busy,
                               Explained result) noexcept {
    const Checked instances = arrivals(m, busy, 0);
    if (!instances.ok()) return result;
    std::int64_t window = result.blocking;
    for (std::int64_t q = 0; q < instances.value(); ++q) {
      const auto demand = [&](std::int64_t w) {
        Checked sum = Checked{set_[m].cost} * q + result.blocking +
                      error_delay(bus_, longest_, Checked{w} + set_[m].cost);
        for (std::size_t k = 0; k <= level; ++k)
          if (k != m) sum += arrivals(k, w, bus_.bit) * set_[k].cost;
        return sum;
      };
      if (!solve(window, demand)) return unknown(result);
      const Checked response = Checked{set_[m].jitter} + window - Checked{set_[m].period} * q + set_[m].cost;
      if (!take(result, m, response, q, window)) return unknown(result);
      result.instances = static_cast<std::size_t>(q + 1);
    }
    return judged(result);
  }

  /// m is queued at x; of its own node only what was queued by then goes before it.
  constexpr Explained in_fifo(std::size_t m, std::size_t level, std::int64_t busy,
                              Explained result) noexcept {
    std::int64_t instance = 0;
    std::int64_t window = 0;
    for (std::int64_t x = 0;;) {
      Checked before = Checked{result.blocking} - set_[m].cost;
      for (std::size_t k = 0; k <= level; ++k)
        if (set_[k].node == set_[m].node) before += queued(k, x) * set_[k].cost;
      const auto demand = [&](std::int64_t w) {
        Checked sum = before + error_delay(bus_, longest_, Checked{w} + set_[m].cost);
        for (std::size_t k = 0; k <= level; ++k)
          if (set_[k].node != set_[m].node) sum += arrivals(k, w, bus_.bit) * set_[k].cost;
        return sum;
      };
      if (!solve(window, demand)) return unknown(result);
      const Checked response = Checked{set_[m].jitter} + window - x + set_[m].cost;
      if (!take(result, m, response, instance, window)) return unknown(result);
      result.instances = static_cast<std::size_t>(++instance);
      // The next time at which one of the node's messages is queued.
      std::int64_t next = unbounded;
      for (std::size_t k = 0; k <= level; ++k) {
        if (set_[k].node != set_[m].node) continue;
        const Checked then = queued(k, x) * set_[k].period - set_[k].jitter;
        next = std::min(next, then.value_or(unbounded));
      }
      if (next >= busy) break;
      x = next;
    }
    return judged(result);
  }

  /// Takes a response time as the result if it is the worst so far. false: it has no number.
  constexpr bool take(Explained& result, std::size_t m, Checked response, std::int64_t instance,
                      std::int64_t window) const noexcept {
    if (!response.ok()) return false;
    if (result.bounded() && response.value() <= result.response) return true;
    result.response = response.value();
    result.instance = static_cast<std::size_t>(instance);
    result.interference = window - result.blocking;
    result.largest = no_index;
    result.largest_share = 0;
    for (std::size_t k = 0; k <= level_[m]; ++k) {
      if (k == m) continue;
      const std::int64_t share = (arrivals(k, window, bus_.bit) * set_[k].cost).value_or(unbounded);
      if (share <= result.largest_share) continue;
      result.largest = k;
      result.largest_share = share;
    }
    return true;
  }
  static constexpr Explained unknown(Explained result) noexcept {
    result.response = unbounded;
    return result;
  }
  static constexpr Explained judged(Explained result) noexcept {
    result.reason = result.response <= result.deadline ? Reason::schedulable : Reason::misses_deadline;
    return result;
  }

  /// How often k can be offered to the bus in a window.
  [[nodiscard]] constexpr Checked arrivals(std::size_t k, std::int64_t window,
                                           std::int64_t slack) const noexcept {
    return ceil_div(Checked{window} + offered_[k] + slack, set_[k].period);
  }
  /// How often k can be queued from 0 to x, both included.
  [[nodiscard]] constexpr Checked queued(std::size_t k, std::int64_t x) const noexcept {
    return floor_div(Checked{x} + set_[k].jitter, set_[k].period) + 1;
  }

  /// From a lower bound up to the least window that holds its own demand. false: no end in sight.
  template <class Demanded>
  constexpr bool solve(std::int64_t& window, Demanded&& demanded) noexcept {
    for (;;) {
      left_ -= static_cast<std::int64_t>(set_.size());
      const Checked next = demanded(window);
      if (!next.ok() || left_ < 0) return false;
      if (next.value() <= window) return true;
      window = next.value();
    }
  }

  std::span<const Message> set_;
  std::span<const NodeQueue> nodes_;
  CanBus bus_;
  std::array<std::int64_t, N> offered_{};    ///< J + f: how late a message can be offered to the bus
  std::array<std::int64_t, N> responses_{};  ///< of the last pass
  std::array<std::size_t, N> level_{};       ///< at which its node may offer while it waits
  std::array<Explained, N> results_{};
  std::int64_t longest_ = 0;
  std::int64_t left_ = 0;
};

}  // namespace ocm::analysis
