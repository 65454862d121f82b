/// Response times of CAN messages under fixed priorities without preemption, exact: the whole busy period of
/// each level is looked at, not its first instance only. [Davis, Burns, Bril, Lukkien 2007, "Controller Area
/// Network (CAN) schedulability analysis: Refuted, revisited and revised", equations 6 to 11]
///
///     B      = longest C below m
///     t      = E(t) + B + sum over k <= m of ceil((t + J_k) / T_k) C_k          the busy period
///     Q      = ceil((t + J_m) / T_m)
///     w(q)   = E(w + C_m) + B + q C_m + sum over k < m of ceil((w + J_k + tau_bit) / T_k) C_k
///     R      = max over q < Q of J_m + w(q) - q T_m + C_m
///
/// R ends with the frame's intermission, as C does: a receiver has the frame 3 bits earlier.
///
/// Assumed: identifiers differ; a node offers the most urgent of its frames at every arbitration (queues that
/// do otherwise: can_queues.hpp); hand-over at bit boundaries (at other times: one bit more). A bit of no
/// length is one that is shorter than a tick.
///
/// How: in one walk forward. With n instances of m, its windows and busy periods are
///
///     w(q) = least w: w = E(w + C_m) + B + q C_m + demand above m until w + tau_bit
///     t(n) = least t: t = E(t) + B + n C_m + demand above m until t;     Q = least n: t(n) + J_m <= n T_m
///
/// and w(0) <= t(1) <= w(1) <= ... <= t(Q) <= w(0) of the level below, where B is the same. So each release
/// is looked at once for all levels together, not once a level. Where B shrinks, go_on() sees whether the
/// last steps still hold for the level below.
///
/// Cost: 100 messages take some 5 us on a host at a load of 0.5 and 40 us at 0.99, 2048 some 0.4 and 6 ms
/// (bench/). Memory: 115 bytes a message.
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

/// What the first messages of a set ask for until a horizon that only grows: all their releases before it, as
/// early as they can come. Each knows until when it has no new release, and each group of messages the least
/// of those: most groups have nothing new when the horizon grows.
template <std::size_t N>
class Demand {
 public:
  /// Of no message, until 0.
  constexpr void restart() noexcept {
    size_ = 0;
    horizon_ = 0;
    sum_ = 0;
    largest_ = no_index;
    largest_share_ = 0;
  }
  /// As `other` is. O(its size), whatever N is.
  constexpr void restart_as(const Demand& other) noexcept {
    size_ = other.size_;
    horizon_ = other.horizon_;
    sum_ = other.sum_;
    largest_ = other.largest_;
    largest_share_ = other.largest_share_;
    for (std::size_t k = 0; k < size_; ++k) {
      shares_[k] = other.shares_[k];
      holds_until_[k] = other.holds_until_[k];
    }
    for (std::size_t g = 0; g * group < size_; ++g) group_holds_until_[g] = other.group_holds_until_[g];
  }

  [[nodiscard]] constexpr std::int64_t horizon() const noexcept { return horizon_; }
  [[nodiscard]] constexpr Checked sum() const noexcept { return sum_; }
  /// Who asks for the most, the most urgent of equals; no_index: none asks.
  [[nodiscard]] constexpr std::size_t largest() const noexcept { return largest_; }
  [[nodiscard]] constexpr std::int64_t largest_share() const noexcept { return largest_share_; }

  constexpr void add(const Message& message) noexcept {
    const std::size_t k = size_++;
    const Checked releases = ceil_div(Checked{horizon_} + message.jitter, message.period);
    shares_[k] = 0;
    ask(k, releases * message.cost);
    // Beyond 63 bits nothing is new any more.
    holds_until_[k] = (releases * message.period - message.jitter).value_or(unbounded);
    std::int64_t& least = group_holds_until_[k / group];
    least = k % group == 0 ? holds_until_[k] : std::min(least, holds_until_[k]);
  }
  /// The horizon is `horizon` now, no nearer than before; or, on the way to where it is `rest` beyond the
  /// sum, farther. Returns how many messages it looked at.
  constexpr std::size_t grow(std::span<const Message> set, std::int64_t horizon, Checked rest) noexcept {
    horizon_ = horizon;
    std::size_t looked_at = 0;
    for (std::size_t g = 0; g * group < size_; ++g) {
      if (horizon_ <= group_holds_until_[g]) continue;
      const std::size_t end = std::min((g + 1) * group, size_);
      std::int64_t least = unbounded;
      for (std::size_t k = g * group; k < end; ++k) {
        if (horizon_ > holds_until_[k]) {
          catch_up(k, set[k]);
          horizon_ = std::max(horizon_, (sum_ + rest).value_or(horizon_));
        }
        least = std::min(least, holds_until_[k]);
      }
      group_holds_until_[g] = least;
      looked_at += group;
    }
    return looked_at + size_ / group + 1;
  }

 private:
  static constexpr std::size_t group = 16;

  /// Nearly always there is one new release.
  constexpr void catch_up(std::size_t k, const Message& message) noexcept {
    Checked cost = message.cost;
    Checked time = message.period;
    if (const std::int64_t late = horizon_ - holds_until_[k]; late > message.period) {
      const Checked releases = ceil_div(late, message.period);
      cost *= releases;
      time *= releases;
    }
    ask(k, cost);
    holds_until_[k] = (time + holds_until_[k]).value_or(unbounded);
  }
  constexpr void ask(std::size_t k, Checked more) noexcept {
    sum_ += more;
    shares_[k] = (more + shares_[k]).value_or(unbounded);
    if (shares_[k] < largest_share_ || (shares_[k] == largest_share_ && k > largest_)) return;
    largest_ = k;
    largest_share_ = shares_[k];
  }

  std::array<std::int64_t, N> shares_{};       ///< what each asks for
  std::array<std::int64_t, N> holds_until_{};  ///< the furthest horizon for which that holds
  std::array<std::int64_t, N / group + 1> group_holds_until_{};
  std::size_t size_ = 0;
  std::int64_t horizon_ = 0;
  Checked sum_;
  std::size_t largest_ = no_index;
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

/// No observer of each instance.
inline constexpr auto unobserved = [](std::size_t, std::int64_t, std::int64_t) {};

/// Analyses sets of up to N messages. It holds its memory and the results of the last set.
template <std::size_t N>
class CanResponse {
 public:
  /// One result a message, valid until the next call. A set of more than N, and one with a number that means
  /// nothing, is bad_input throughout. `limits` are for each message; beyond them it is too_long.
  ///
  /// observe(m, q, response) is called for each release q = 0, 1, ... of the busy period of each message m,
  /// the most urgent first. If no bound is found in the end, what it got of m is void.
  template <class Observer = decltype(unobserved)>
  constexpr std::span<const Explained> analyse(std::span<const Message> set, const CanBus& bus,
                                               CanTest test = CanTest::exact, Limits limits = {},
                                               Observer&& observe = Observer{}) noexcept {
    const std::size_t count = std::min(set.size(), N);
    const std::size_t bad = set.size() > N ? N : first_bad_on(set, bus);
    for (std::size_t m = 0; m < count; ++m) {
      results_[m] = {};
      results_[m].deadline = set[m].due();
      results_[m].largest = bad;
    }
    if (bad == no_index && valid(bus)) {
      set_ = set;
      bus_ = bus;
      test_ = test;
      find_blocking();
      sweep(limits, observe);
    }
    return {results_.data(), count};
  }

 private:
  using Demand = detail::Demand<N>;

  /// A message whose numbers mean nothing; so does a frame that is shorter than a bit.
  [[nodiscard]] static constexpr std::size_t first_bad_on(std::span<const Message> set,
                                                          const CanBus& bus) noexcept {
    for (std::size_t m = 0; m < set.size(); ++m)
      if (set[m].cost < bus.bit) return std::min(m, first_bad(set));
    return first_bad(set);
  }

  constexpr void find_blocking() noexcept {
    std::size_t longest = no_index;
    for (std::size_t m = set_.size(); m-- > 0;) {
      Explained& result = results_[m];
      result.blocked_by = longest;
      result.blocking = longest == no_index ? 0 : set_[longest].cost;
      if (longest == no_index || set_[m].cost >= set_[longest].cost) longest = m;
    }
  }

  template <class Observer>
  constexpr void sweep(Limits limits, Observer& observe) noexcept {
    shared_.restart();
    longest_ = 0;
    load_ = 0;
    heaviest_ = no_index;
    std::int64_t heaviest_parts = -1;
    bool overloaded = false;
    for (std::size_t m = 0; m < set_.size(); ++m) {
      const Message& message = set_[m];
      longest_ = std::max(longest_, message.cost);
      left_ = limits.terms;
      if (m > 0) shared_.add(set_[m - 1]);

      const std::int64_t parts = detail::load_parts(message.cost, message.period);
      // Alone it does not delay its own first instance. Once it is overloaded, the sum says no more, and may
      // not have the room.
      if (test_ == CanTest::exact && !overloaded) load_ += parts;
      overloaded = overloaded || is_overloaded(m);
      if (overloaded) {
        results_[m].reason = Reason::overloaded;
        results_[m].largest = heaviest_;
      } else {
        respond(m, observe);
      }
      if (test_ == CanTest::sufficient && !overloaded) load_ += parts;
      if (parts > heaviest_parts) {
        heaviest_parts = parts;
        heaviest_ = m;
      }
    }
  }

  /// Each instance in turn, until the busy period has ended.
  template <class Observer>
  constexpr void respond(std::size_t m, Observer& observe) noexcept {
    const Message& message = set_[m];
    Explained worst = results_[m];
    worst.blocking = base_of(m);
    Demand* demand = &shared_;
    std::int64_t window = worst.blocking;
    for (std::int64_t q = 0;; ++q) {
      // w(q)
      const Checked own = Checked{message.cost} * q + worst.blocking;
      demand = &go_on(m, q, *demand);
      window = std::max(window, demand->horizon() - bus_.bit);
      if (!solve(*demand, own, bus_.bit, message.cost, window)) return give_up(m);
      const Checked response = Checked{message.jitter} + window - Checked{message.period} * q + message.cost;
      if (!response.ok()) return give_up(m);
      observe(m, q, response.value());
      worst.instances = static_cast<std::size_t>(q) + 1;
      if (q == 0 || response.value() > worst.response) {
        worst.response = response.value();
        worst.instance = static_cast<std::size_t>(q);
        worst.interference = window - own.value();
        worst.largest = demand->largest();
        worst.largest_share = demand->largest_share();
      }
      if (test_ == CanTest::sufficient) break;

      // The next instance belongs to the busy period if it is released before this one has been sent; or
      // before the period ends, which may be later.
      const Checked sent = Checked{window} + message.cost;
      const Checked next = Checked{message.period} * (q + 1) - message.jitter;
      if (!sent.ok() || !next.ok()) return give_up(m);
      window = sent.value();
      if (window > next.value()) continue;
      demand = &go_on(m, q + 1, *demand);
      std::int64_t end = std::max(window, demand->horizon());
      if (!solve(*demand, own + message.cost, 0, 0, end)) return give_up(m);
      if (end <= next.value()) break;
    }
    conclude(m, worst);
  }

  constexpr void conclude(std::size_t m, Explained worst) noexcept {
    const Message& message = set_[m];
    if (test_ == CanTest::sufficient) {
      // The instance before it may have been pushed into its time.
      if (message.cost > results_[m].blocking) worst.blocked_by = m;
      worst.deadline = std::min(worst.deadline, message.period);
    }
    worst.reason = worst.response <= worst.deadline ? Reason::schedulable : Reason::misses_deadline;
    results_[m] = worst;
  }

  /// From a lower bound on, the least window that holds `own`, the demand until `slack` after the window and
  /// the errors until `frame` after it. false: no end in sight.
  [[nodiscard]] constexpr bool solve(Demand& demand, Checked own, std::int64_t slack, std::int64_t frame,
                                     std::int64_t& window) noexcept {
    for (;;) {
      const Checked horizon = Checked{window} + slack;
      if (!horizon.ok()) return false;
      const Checked rest = own + error_delay(bus_, longest_, Checked{window} + frame);
      // All come at 0, however short a bit is.
      const auto until = std::max<std::int64_t>(horizon.value(), 1);
      left_ -= static_cast<std::int64_t>(demand.grow(set_, until, rest + slack));
      const Checked next = demand.sum() + rest;
      if (!next.ok() || left_ < 0) return false;
      if (next.value() <= window) return true;
      window = next.value();
    }
  }

  /// w(0) without interference and errors.
  [[nodiscard]] constexpr std::int64_t base_of(std::size_t m) const noexcept {
    const std::int64_t blocking = results_[m].blocking;
    return test_ == CanTest::exact ? blocking : std::max(blocking, set_[m].cost);
  }

  /// Where the demand of level m can go on to the end of q of its instances: in what all levels share while
  /// the level below begins no earlier than that, else in a copy.
  [[nodiscard]] constexpr Demand& go_on(std::size_t m, std::int64_t q, Demand& demand) noexcept {
    if (&demand != &shared_ || below_goes_as_far(m, q)) return demand;
    apart_.restart_as(shared_);
    if (q == 0) {  // the level below begins before this one does
      shared_.restart();
      for (std::size_t k = 0; k < m; ++k) shared_.add(set_[k]);
      left_ -= static_cast<std::int64_t>(m);
    }
    return apart_;
  }
  /// The level below has B' for B, and the releases of m that there are by then for q. If B' + releases * C
  /// is no less than B + q C, then its first window is no shorter than that of q instances here. Errors count
  /// until the end of its own frame, which is no sooner, either: B' + C' >= B; but for the sufficient test.
  [[nodiscard]] constexpr bool below_goes_as_far(std::size_t m, std::int64_t q) const noexcept {
    if (m + 1 == set_.size()) return true;
    const Message& message = set_[m];
    const std::int64_t base = base_of(m);
    const std::int64_t base_below = base_of(m + 1);
    if (bus_.errors.every > 0 && Checked{base_below} + set_[m + 1].cost < base) return false;
    const std::int64_t by_then = std::max({q == 0 ? 0 : shared_.horizon(), bus_.bit, std::int64_t{1}});
    const Checked releases = ceil_div(Checked{by_then} + message.jitter, message.period);
    return releases * message.cost + base_below >= Checked{message.cost} * q + base;
  }

  /// What one error costs on this level.
  [[nodiscard]] constexpr Checked fault() const noexcept {
    return Checked{error_frame_bits} * bus_.bit + longest_;
  }

  /// U of the level, with that of its errors, leaves nothing, so that its busy period has no end.
  [[nodiscard]] constexpr bool is_overloaded(std::size_t m) const noexcept {
    const std::int64_t errors =
        bus_.errors.every > 0 ? detail::load_parts(fault().value_or(unbounded), bus_.errors.every) : 0;
    // Each of the quotients may be a part too low.
    if (load_ + errors + static_cast<std::int64_t>(m) + 2 < detail::load_one) return false;
    const Comparison comparison = exact_load(m);
    // At 1 exactly, with nothing but the messages themselves, it ends with the hyperperiod.
    return comparison == Comparison::above ||
           (comparison == Comparison::equal && (results_[m].blocking > 0 || bus_.errors.burst > 0));
  }
  [[nodiscard]] constexpr Comparison exact_load(std::size_t m) const noexcept {
    Utilisation sum = utilisation(set_.first(test_ == CanTest::sufficient ? m : m + 1));
    if (bus_.errors.every > 0) sum.add(fault().value_or(unbounded), bus_.errors.every);
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
  Demand shared_;                    ///< of the levels above, no further than the next level begins
  Demand apart_;                     ///< of one level that goes further
  std::int64_t longest_ = 0;         ///< C of this level and above
  std::int64_t load_ = 0;            ///< U of this level and above, in parts of 2^30, too low if at all
  std::size_t heaviest_ = no_index;  ///< of the messages above, the one with the greatest C / T
  std::int64_t left_ = 0;            ///< terms that this message's analysis may still take
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
