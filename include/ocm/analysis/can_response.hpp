/// Response times of CAN messages under fixed priorities without preemption, exact: the whole busy period of
/// each level is looked at, not its first instance only. [Davis, Burns, Bril, Lukkien 2007, "Controller Area
/// Network (CAN) schedulability analysis: Refuted, revisited and revised", equations 6 to 11]
///
///     B      = longest C below m
///     t      = E(t) + B + sum over k <= m of ceil((t + J_k) / T_k) C_k
///     Q      = ceil((t + J_m) / T_m)
///     w(q)   = E(w + C_m) + B + q C_m + sum over k < m of ceil((w + J_k + tau_bit) / T_k) C_k
///     R      = max over q < Q of J_m + w(q) - q T_m + C_m
///
/// R ends with the frame's intermission, as C does: a receiver has the frame 3 bits earlier.
///
/// Assumed: identifiers differ; a node offers the most urgent of its frames at every arbitration (queues that
/// do otherwise: can_queues.hpp); hand-over at bit boundaries (at other times: one bit more).
///
/// Cost: levels are analysed from the top, and what a level has computed is the next one's start. For each
/// only those releases are looked at that are new, so that a set of n costs O(n^2) comparisons and few
/// divisions: 100 messages take some 20 us on a host, 2048 some 3 ms (bench/). Memory: 140 bytes a message.
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

enum class CanTest : std::uint8_t {
  exact,
  /// One instance, for D <= T: w = max(B, C_m) + ... A bound where it is within min(D, T), which then stands
  /// as deadline. [Davis et al. 2007, equation 16]
  sufficient,
};

namespace detail {

/// The interference of the first messages of a set over a window that only grows. For each the count of its
/// releases is kept, with the longest window for which it holds, and for each group of messages the least of
/// those: most groups have nothing new when the window grows.
template <std::size_t N>
class Demand {
 public:
  /// Of no message. A release counts that comes up to `slack` after the window: tau_bit, or nothing.
  constexpr void restart(std::int64_t slack) noexcept {
    slack_ = slack;
    size_ = 0;
    sum_ = 0;
    largest_ = nobody;
    largest_share_ = 0;
  }
  /// As `other` is. O(its size), whatever N is.
  constexpr void restart_as(const Demand& other) noexcept {
    restart(other.slack_);
    size_ = other.size_;
    sum_ = other.sum_;
    largest_ = other.largest_;
    largest_share_ = other.largest_share_;
    for (std::size_t k = 0; k < size_; ++k) {
      releases_[k] = other.releases_[k];
      holds_until_[k] = other.holds_until_[k];
    }
    for (std::size_t g = 0; g * group < size_; ++g) group_holds_until_[g] = other.group_holds_until_[g];
  }

  [[nodiscard]] constexpr Checked sum() const noexcept { return sum_; }
  /// Whose interference is the greatest, the most urgent of equals; nobody without any.
  [[nodiscard]] constexpr std::size_t largest() const noexcept { return largest_; }
  [[nodiscard]] constexpr std::int64_t largest_share() const noexcept { return largest_share_; }

  constexpr void add(const Message& message, std::int64_t window) noexcept {
    const std::size_t k = size_++;
    releases_[k] = 0;
    count(k, message, window);
    std::int64_t& least = group_holds_until_[k / group];
    least = k % group == 0 ? holds_until_[k] : std::min(least, holds_until_[k]);
  }
  /// The window is `window` now, no shorter than before. Returns how many messages it looked at.
  constexpr std::size_t grow(std::span<const Message> set, std::int64_t window) noexcept {
    std::size_t looked_at = 0;
    for (std::size_t g = 0; g * group < size_; ++g) {
      if (window <= group_holds_until_[g]) continue;
      const std::size_t end = std::min((g + 1) * group, size_);
      std::int64_t least = unbounded;
      for (std::size_t k = g * group; k < end; ++k) {
        if (window > holds_until_[k]) count(k, set[k], window);
        least = std::min(least, holds_until_[k]);
      }
      group_holds_until_[g] = least;
      looked_at += group;
    }
    return looked_at + size_ / group + 1;
  }

 private:
  static constexpr std::size_t group = 16;

  constexpr void count(std::size_t k, const Message& message, std::int64_t window) noexcept {
    const Checked releases = ceil_div(Checked{window} + message.jitter + slack_, message.period);
    sum_ += (releases - releases_[k]) * message.cost;
    releases_[k] = releases.value_or(releases_[k]);
    // Beyond 63 bits nothing is new any more.
    holds_until_[k] = (releases * message.period - message.jitter - slack_).value_or(unbounded);
    const std::int64_t share = (releases * message.cost).value_or(unbounded);
    if (share < largest_share_ || (share == largest_share_ && k > largest_)) return;
    largest_ = k;
    largest_share_ = share;
  }

  std::array<std::int64_t, N> releases_{};
  std::array<std::int64_t, N> holds_until_{};
  std::array<std::int64_t, N / group + 1> group_holds_until_{};
  std::int64_t slack_ = 0;
  std::size_t size_ = 0;
  Checked sum_;
  std::size_t largest_ = nobody;
  std::int64_t largest_share_ = 0;
};

/// C / T in parts of 2^30, rounded down: enough to tell most loads from 1, with one division. What it cannot
/// tell, Utilisation does.
inline constexpr std::int64_t load_one = std::int64_t{1} << 30;
constexpr std::int64_t load_parts(std::int64_t cost, std::int64_t period) noexcept {
  if (cost < std::int64_t{1} << 32) return cost * load_one / period;
  return static_cast<std::int64_t>(fraction_of(cost % period, period).low >> (point - 30)) +
         std::min<std::int64_t>(cost / period, 4) * load_one;
}

}  // namespace detail

/// Analyses sets of up to N messages. It holds its memory and the results of the last set.
template <std::size_t N>
class CanResponse {
 public:
  /// One result a message, valid until the next call. A set of more than N, and one with a number that means
  /// nothing, is bad_input throughout. `limits` are for each message; beyond them it is too_long.
  constexpr std::span<const Explained> analyse(std::span<const Message> set, const CanBus& bus,
                                               CanTest test = CanTest::exact, Limits limits = {}) noexcept {
    const std::size_t count = std::min(set.size(), N);
    const std::size_t bad = set.size() > N ? N : first_bad(set);
    for (std::size_t m = 0; m < count; ++m) {
      results_[m] = {};
      results_[m].deadline = set[m].due();
      results_[m].largest = bad;
    }
    if (bad == nobody && valid(bus)) {
      set_ = set;
      bus_ = bus;
      test_ = test;
      find_blocking();
      sweep(limits);
    }
    return {results_.data(), count};
  }

 private:
  using Demand = detail::Demand<N>;

  constexpr void find_blocking() noexcept {
    std::size_t longest = nobody;
    for (std::size_t m = set_.size(); m-- > 0;) {
      Explained& result = results_[m];
      result.blocked_by = longest;
      result.blocking = longest == nobody ? 0 : set_[longest].cost;
      if (longest == nobody || set_[m].cost >= set_[longest].cost) longest = m;
    }
  }

  constexpr void sweep(Limits limits) noexcept {
    queueing_.restart(bus_.bit);
    busy_.restart(0);
    longest_ = 0;
    load_ = 0;
    heaviest_ = nobody;
    std::int64_t heaviest_parts = -1;
    bool overloaded = false;
    std::int64_t window = 0;  // w of the level above: where this level's begins
    std::int64_t base = 0;
    std::int64_t busy = 0;
    for (std::size_t m = 0; m < set_.size(); ++m) {
      const Message& message = set_[m];
      Explained& result = results_[m];
      longest_ = std::max(longest_, message.cost);
      left_ = limits.terms;

      // The level above had `base` and no interference of the message just above. If what it had is no more
      // than what this level has with that message in it, its window is a lower bound here.
      const bool sufficient = test_ == CanTest::sufficient;
      const std::int64_t own_base = sufficient ? std::max(result.blocking, message.cost) : result.blocking;
      if (m > 0) {
        const bool goes_on = bus_.errors.burst == 0 && own_base >= base - set_[m - 1].cost;
        if (goes_on) {
          queueing_.add(set_[m - 1], window);
        } else {
          queueing_.restart(bus_.bit);
          window = own_base;
          for (std::size_t k = 0; k < m; ++k) queueing_.add(set_[k], window);
          left_ -= static_cast<std::int64_t>(m);
        }
      }
      base = own_base;
      window = std::max(window, own_base);

      const std::int64_t parts = detail::load_parts(message.cost, message.period);
      if (!sufficient) load_ += parts;  // alone it does not delay its own first instance
      overloaded = overloaded || is_overloaded(m);
      if (overloaded) {
        result.reason = Reason::overloaded;
        result.largest = heaviest_;
      } else {
        respond(m, own_base, window, busy);
      }
      if (sufficient) load_ += parts;
      if (parts > heaviest_parts) {
        heaviest_parts = parts;
        heaviest_ = m;
      }
    }
  }

  constexpr void respond(std::size_t m, std::int64_t base, std::int64_t& window,
                         std::int64_t& busy) noexcept {
    const Message& message = set_[m];
    Checked instances = 1;
    if (test_ == CanTest::exact) {
      busy_.add(message, busy);
      if (!busy_period(m, busy)) return give_up(m);
      instances = ceil_div(Checked{busy} + message.jitter, message.period);
    }
    if (!instances.ok() || !queueing(m, base, queueing_, window)) return give_up(m);
    conclude(m, base, window, instances.value());
  }

  /// The level's busy period, from that of the level above on. false: no end in sight.
  [[nodiscard]] constexpr bool busy_period(std::size_t m, std::int64_t& busy) noexcept {
    busy = std::max(busy, results_[m].blocking + 1);
    for (;;) {
      left_ -= static_cast<std::int64_t>(busy_.grow(set_, busy));
      const Checked next = busy_.sum() + results_[m].blocking + error_delay(bus_, longest_, busy);
      if (!next.ok() || left_ < 0) return false;
      if (next.value() <= busy) return true;
      busy = next.value();
    }
  }

  /// w(q), from a lower bound on: `base` is all that is not interference. false: no end in sight.
  [[nodiscard]] constexpr bool queueing(std::size_t m, Checked base, Demand& demand,
                                        std::int64_t& window) noexcept {
    for (;;) {
      left_ -= static_cast<std::int64_t>(demand.grow(set_, window));
      const Checked next = demand.sum() + base + error_delay(bus_, longest_, Checked{window} + set_[m].cost);
      if (!next.ok() || left_ < 0) return false;
      if (next.value() <= window) return true;
      window = next.value();
    }
  }

  constexpr void conclude(std::size_t m, std::int64_t base, std::int64_t first_window,
                          std::int64_t instances) noexcept {
    const Message& message = set_[m];
    Explained& result = results_[m];
    std::int64_t window = first_window;
    std::int64_t worst_window = window;
    Checked worst = Checked{message.jitter} + window + message.cost;
    std::int64_t worst_instance = 0;
    if (instances > 1) {
      // The levels below begin where the first instance ends.
      later_.restart_as(queueing_);
      for (std::int64_t q = 1; q < instances; ++q) {
        const Checked start = Checked{window} + message.cost;
        window = start.value_or(window);
        const Checked own = Checked{message.cost} * q;
        if (!start.ok() || !queueing(m, own + base, later_, window)) return give_up(m);
        const Checked response =
            Checked{message.jitter} + window - Checked{message.period} * q + message.cost;
        if (!response.ok()) return give_up(m);
        if (response > worst) {
          worst = response;
          worst_instance = q;
          worst_window = window;
        }
      }
    }
    if (!worst.ok()) return give_up(m);
    result.response = worst.value();
    result.instance = static_cast<std::size_t>(worst_instance);
    result.instances = static_cast<std::size_t>(instances);
    result.blocking = base;
    result.interference = worst_window - base - message.cost * worst_instance;
    if (test_ == CanTest::sufficient) {
      if (message.cost > base || result.blocked_by == nobody || set_[result.blocked_by].cost < base)
        result.blocked_by = m;  // by the instance before it, which may have been pushed into its time
      result.deadline = std::min(result.deadline, message.period);
    }
    result.reason = result.response <= result.deadline ? Reason::schedulable : Reason::misses_deadline;
    const Demand& last = instances == 1 ? queueing_ : later_;
    result.largest = last.largest();
    result.largest_share = last.largest_share();
    if (worst_instance != instances - 1) find_largest(m, worst_window);
  }

  /// From scratch, for a window in between.
  constexpr void find_largest(std::size_t m, std::int64_t window) noexcept {
    Explained& result = results_[m];
    result.largest = nobody;
    result.largest_share = 0;
    for (std::size_t k = 0; k < m; ++k) {
      const Checked releases = ceil_div(Checked{window} + set_[k].jitter + bus_.bit, set_[k].period);
      const std::int64_t share = (releases * set_[k].cost).value_or(unbounded);
      if (share <= result.largest_share) continue;
      result.largest = k;
      result.largest_share = share;
    }
  }

  /// U of the level, with that of its errors, leaves nothing, so that its busy period has no end.
  [[nodiscard]] constexpr bool is_overloaded(std::size_t m) const noexcept {
    const std::int64_t fault = (Checked{error_frame_bits} * bus_.bit + longest_).value_or(unbounded);
    const std::int64_t errors = bus_.errors.every > 0 ? detail::load_parts(fault, bus_.errors.every) : 0;
    // Each of the quotients may be a part too low.
    if (load_ + errors + static_cast<std::int64_t>(m) + 2 < detail::load_one) return false;
    const Comparison comparison = exact_load(m);
    // At 1 exactly, with nothing but the messages themselves, it ends with the hyperperiod.
    return comparison == Comparison::above ||
           (comparison == Comparison::equal && (results_[m].blocking > 0 || bus_.errors.burst > 0));
  }
  [[nodiscard]] constexpr Comparison exact_load(std::size_t m) const noexcept {
    Utilisation sum = utilisation(set_.first(test_ == CanTest::sufficient ? m : m + 1));
    if (bus_.errors.every > 0)
      sum.add((Checked{error_frame_bits} * bus_.bit + longest_).value_or(unbounded), bus_.errors.every);
    return sum.versus_one();
  }

  /// Without an end in sight, a load that leaves nothing is the reason; otherwise the limits are.
  constexpr void give_up(std::size_t m) noexcept {
    results_[m].reason = exact_load(m) == Comparison::below ? Reason::too_long : Reason::overloaded;
    results_[m].largest = heaviest_;
  }

  std::span<const Message> set_;
  CanBus bus_;
  CanTest test_ = CanTest::exact;
  Demand queueing_;
  Demand busy_;
  Demand later_;
  std::int64_t longest_ = 0;       ///< C of this level and above
  std::int64_t load_ = 0;          ///< U of this level and above, in parts of 2^30, too low if at all
  std::size_t heaviest_ = nobody;  ///< of the messages above, the one with the greatest C / T
  std::int64_t left_ = 0;          ///< terms that this message's analysis may still take
  std::array<Explained, N> results_{};
};

/// Analyses one set, for constant expressions and tests: the results by value.
template <std::size_t N>
[[nodiscard]] constexpr std::array<Explained, N> can_response_times(const std::array<Message, N>& set,
                                                                    const CanBus& bus = {},
                                                                    CanTest test = CanTest::exact) noexcept {
  CanResponse<N> analysis;
  std::array<Explained, N> results{};
  const auto found = analysis.analyse(set, bus, test);
  for (std::size_t i = 0; i < N; ++i) results[i] = found[i];
  return results;
}

}  // namespace ocm::analysis
