/// Messages of one node that are released by one clock with fixed offsets: they cannot all come at once, and
/// what they ask of the bus in a window is less than without offsets. [Tindell 1994, "Adding time-offsets to
/// schedulability analysis"; Yomsi, Bertrand, Navet, Davis 2012, "Controller Area Network (CAN): response
/// time analysis with offsets"]
///
/// Nodes have clocks of their own, so each can begin its pattern anywhere. For each node the worst place of a
/// window in its pattern is searched for again in each step of the iteration, among those that begin with a
/// release; they are as many as the node releases in its hyperperiod. Between nodes the bound is that of
/// can_response.hpp, with
///
///     sum over nodes of max over s of sum over k of the node of
///         releases of k that can fall into [s, s + w + tau_bit)
///
/// in place of the sum of ceilings. A message's own node counts with its worst place, too, wherever in the
/// pattern the message itself is: sufficient, never above the analysis without offsets, exact for none.
///
/// A node whose pattern has more than `most_releases` counts without its offsets. Cost: O(n * releases of the
/// hyperperiod) a step of the iteration: for tools.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>

#include "ocm/analysis/checked.hpp"
#include "ocm/analysis/message_set.hpp"
#include "ocm/analysis/utilisation.hpp"
#include "ocm/analysis/verdict.hpp"

namespace ocm::analysis {

/// Analyses sets of up to N messages; `Message::node` below `Nodes`.
template <std::size_t N, std::size_t Nodes>
class CanOffsets {
 public:
  /// One result a message, valid until the next call. bad_input throughout: a set of more than N, a number
  /// that means nothing, a node that is not there.
  constexpr std::span<const Explained> analyse(std::span<const Message> set, const CanBus& bus,
                                               Limits limits = {},
                                               std::int64_t most_releases = 10'000) noexcept {
    set_ = set.first(std::min(set.size(), N));
    bus_ = bus;
    std::size_t bad = set.size() > N ? N : first_bad(set);
    for (std::size_t m = 0; m < set_.size() && bad == no_index; ++m)
      if (set_[m].node >= Nodes) bad = m;
    for (std::size_t m = 0; m < set_.size(); ++m) results_[m] = {.deadline = set_[m].due(), .largest = bad};
    if (bad != no_index || !valid(bus)) return {results_.data(), set_.size()};
    Utilisation load;
    std::int64_t longest = 0;
    for (std::size_t m = 0; m < set_.size(); ++m) {
      load.add(set_[m].cost, set_[m].period);
      longest = std::max(longest, set_[m].cost);
      left_ = limits.terms;
      find_patterns(m, most_releases);
      respond(m, longest, load);
    }
    return {results_.data(), set_.size()};
  }

 private:
  /// The hyperperiod of what each node sends at level m or above; 0: offsets do not count.
  constexpr void find_patterns(std::size_t m, std::int64_t most_releases) noexcept {
    for (std::size_t node = 0; node < Nodes; ++node) {
      Checked common = 1;
      for (std::size_t k = 0; k <= m && common.ok(); ++k)
        if (set_[k].node == node) common *= set_[k].period / std::gcd(common.value(), set_[k].period);
      Checked releases = 0;
      for (std::size_t k = 0; k <= m && common.ok(); ++k)
        if (set_[k].node == node) releases += common.value() / set_[k].period;
      // Far from 63 bits, so that places in it can be added.
      const bool short_enough = releases <= Checked{most_releases} && common <= Checked{unbounded / 4};
      patterns_[node] = short_enough ? common.value() : 0;
    }
  }

  /// What messages [0, end) ask for in a window: its worst place in the pattern of each node.
  [[nodiscard]] constexpr Checked demand(std::size_t end, std::int64_t window, std::int64_t slack) noexcept {
    Checked sum = 0;
    for (std::size_t node = 0; node < Nodes; ++node) {
      if (patterns_[node] == 0) {
        for (std::size_t k = 0; k < end; ++k)
          if (set_[k].node == node) sum += together(set_[k], window, slack) * set_[k].cost;
        left_ -= static_cast<std::int64_t>(end);
        continue;
      }
      std::int64_t most = 0;
      for (std::size_t first = 0; first < end; ++first) {
        if (set_[first].node != node) continue;
        const std::int64_t period = set_[first].period;
        for (std::int64_t s = 0; s < patterns_[node] && left_ >= 0; s += period) {
          // The window begins when this release of `first` comes, as late as it can.
          const Checked begin = Checked{set_[first].offset % period} + s + set_[first].jitter;
          Checked asked = 0;
          for (std::size_t k = 0; k < end; ++k)
            if (set_[k].node == node) asked += placed(set_[k], begin, window, slack) * set_[k].cost;
          left_ -= static_cast<std::int64_t>(end);
          if (!asked.ok()) return asked;
          most = std::max(most, asked.value());
        }
      }
      sum += most;
    }
    return sum;
  }

  static constexpr Checked together(const Message& k, std::int64_t window, std::int64_t slack) noexcept {
    return ceil_div(Checked{window} + k.jitter + slack, k.period);
  }
  /// Releases of k planned in [begin - J, begin + window + slack).
  static constexpr Checked placed(const Message& k, Checked begin, std::int64_t window,
                                  std::int64_t slack) noexcept {
    const Checked from = begin - k.jitter - k.offset;
    const Checked to = begin + window + slack - k.offset;
    return ceil_div(to, k.period) - ceil_div(from, k.period);
  }

  constexpr void respond(std::size_t m, std::int64_t longest, Utilisation load) noexcept {
    const Message& message = set_[m];
    Explained& result = results_[m];
    for (std::size_t k = m + 1; k < set_.size(); ++k)
      if (set_[k].cost > result.blocking) {
        result.blocking = set_[k].cost;
        result.blocked_by = k;
      }
    if (bus_.errors.every > 0)
      load.add((Checked{error_frame_bits} * bus_.bit + longest).value_or(unbounded), bus_.errors.every);
    const Comparison comparison = load.versus_one();
    if (comparison == Comparison::above ||
        (comparison == Comparison::equal && (result.blocking > 0 || bus_.errors.burst > 0))) {
      result.reason = Reason::overloaded;
      return;
    }
    result.reason = Reason::too_long;
    std::int64_t busy = 1;
    if (!solve(busy, [&](std::int64_t t) {
          return demand(m + 1, t, 0) + result.blocking + error_delay(bus_, longest, t);
        }))
      return;
    const Checked instances = together(message, busy, 0);
    if (!instances.ok()) return;
    std::int64_t window = result.blocking;
    for (std::int64_t q = 0; q < instances.value(); ++q) {
      const Checked own = Checked{message.cost} * q + result.blocking;
      const bool found = solve(window, [&](std::int64_t w) {
        return demand(m, w, bus_.bit) + own + error_delay(bus_, longest, Checked{w} + message.cost);
      });
      const Checked response = Checked{message.jitter} + window - Checked{message.period} * q + message.cost;
      if (!found || !response.ok()) {
        result.response = unbounded;
        return;
      }
      if (result.bounded() && response.value() <= result.response) continue;
      result.response = response.value();
      result.instance = static_cast<std::size_t>(q);
      result.interference = window - own.value();
    }
    result.instances = static_cast<std::size_t>(instances.value());
    result.reason = result.response <= result.deadline ? Reason::schedulable : Reason::misses_deadline;
  }

  template <class Demanded>
  constexpr bool solve(std::int64_t& window, Demanded&& demanded) noexcept {
    for (;;) {
      const Checked next = demanded(window);
      if (!next.ok() || left_ < 0) return false;
      if (next.value() <= window) return true;
      window = next.value();
    }
  }

  std::span<const Message> set_;
  CanBus bus_;
  std::array<std::int64_t, Nodes> patterns_{};
  std::array<Explained, N> results_{};
  std::int64_t left_ = 0;
};

}  // namespace ocm::analysis
