/// Response times on a processor with fixed priorities and preemption: release jitter, blocking, deadlines
/// beyond the period (all instances of the level's busy period), context switches, interrupts and ticks.
/// [Joseph, Pandya 1986; Audsley, Burns, Richardson, Tindell, Wellings 1993; Tindell, Burns, Wellings 1994]
///
///     w(q) = (q + 1) C + B + sum over k at the same level or above of ceil((w(q) + J_k) / T_k) C_k
///     R    = max over q of w(q) + J - q T, until w(q) + J <= (q + 1) T
///
/// Of a more urgent task that waits, which suspends itself, C_k - W_k counts, and S_k = R_k - (C_k - W_k) in
/// place of J_k: its work can come late, and that of its next job at once [Bletsas, Audsley, Huang, Chen,
/// Nelissen 2018, "Errata for three papers (2004-05) on fixed-priority scheduling with self-suspensions":
/// jitter R - C is safe].
///
///     static_assert(all_schedulable(in_order(std::array{Task{3, 7}, Task{3, 12}, Task{5, 20}})));
///
/// Bounds are exact where all tasks have a level of their own and can be released together, and safe
/// elsewhere. No heap; recursion only where tasks wait, as deep as they have levels, up to 16. Of 16 tasks
/// that wait R_k is calculated, once each; of more, D_k stands in its place, which is safe too. Cost:
/// O(tasks) a step of the iteration; Limits says how many, so that it always ends.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/analysis/checked.hpp"
#include "ocm/analysis/task_set.hpp"
#include "ocm/analysis/utilisation.hpp"
#include "ocm/analysis/verdict.hpp"

namespace ocm::analysis {

namespace detail {

/// How late what tasks that wait take may come. Found once each: the response of one is found from those of
/// the more urgent ones, and theirs from those of still more urgent ones.
class LateWork {
 public:
  /// Where that of task k is, or is to be put; nullptr: there is no room for it.
  [[nodiscard]] constexpr std::int64_t* of(std::size_t k) noexcept {
    for (std::size_t i = 0; i < size_; ++i)
      if (tasks_[i] == k) return &ticks_[i];
    if (size_ == ticks_.size()) return nullptr;
    tasks_[size_] = k;
    return &(ticks_[size_++] = unknown);
  }
  static constexpr std::int64_t unknown = -1;

 private:
  static constexpr std::size_t room = 16;
  std::array<std::int64_t, room> ticks_{};
  std::array<std::size_t, room> tasks_{};
  std::size_t size_ = 0;
};

constexpr Explained response_time(std::span<const Task> tasks, std::size_t index, const Processor& processor,
                                  Limits limits, std::span<std::int64_t> instances,
                                  std::span<std::int64_t> shares, bool only_verdict, LateWork& late) noexcept;

/// One task in its set, on its processor: what delays it.
class ProcessorDemand {
 public:
  constexpr ProcessorDemand(std::span<const Task> tasks, std::size_t index, const Processor& processor,
                            LateWork& late) noexcept
      : tasks_(tasks), index_(index), processor_(processor), late_(late) {}

  [[nodiscard]] constexpr Checked scaled(std::int64_t ticks) const noexcept {
    constexpr std::int64_t million = 1'000'000;
    if (processor_.scale == million) return ticks;
    return ceil_div(Checked{ticks} * processor_.scale, million);
  }
  /// C with its context switches.
  [[nodiscard]] constexpr Checked cost(std::size_t k) const noexcept {
    if (processor_.context_switch == 0) return scaled(tasks_[k].cost);
    return scaled(tasks_[k].cost) + Checked{processor_.context_switch} * tasks_[k].switches;
  }
  /// B with the system's own.
  [[nodiscard]] constexpr Checked blocking() const noexcept {
    return scaled(tasks_[index_].blocking) + processor_.lock;
  }
  /// J with the tick that may just have passed.
  [[nodiscard]] constexpr Checked jitter(std::size_t k) const noexcept {
    return Checked{tasks_[k].jitter} + (processor_.released_by_tick ? processor_.tick_period : 0);
  }
  /// Whether task k is more urgent, and lets the task go on while it waits for less urgent ones.
  [[nodiscard]] constexpr bool suspends(std::size_t k) const noexcept {
    return tasks_[k].waits != 0 && tasks_[k].level < tasks_[index_].level;
  }
  /// C - W, with its context switches.
  [[nodiscard]] constexpr Checked work(std::size_t k) const noexcept {
    return scaled(tasks_[k].cost - tasks_[k].waits) + Checked{processor_.context_switch} * tasks_[k].switches;
  }
  /// What one release of task k, which goes before the task, takes from it.
  [[nodiscard]] constexpr Checked taken(std::size_t k) const noexcept {
    return suspends(k) ? work(k) : cost(k);
  }
  /// How much later than planned what a release of task k takes may come: J, and of one that suspends S, in
  /// which J is. One that may be late for its deadline is late by that at most, or nothing is promised.
  [[nodiscard]] constexpr Checked lateness(std::size_t k) const noexcept {
    if (!suspends(k)) return jitter(k);
    std::int64_t* const place = late_.of(k);
    if (place != nullptr && *place != LateWork::unknown) return *place;
    std::int64_t response = tasks_[k].due();
    if (place != nullptr) {
      const Explained found = response_time(tasks_, k, processor_, {}, {}, {}, false, late_);
      if (found.reason == Reason::schedulable) response = found.response;
    }
    const std::int64_t latest =
        std::max(jitter(k).value_or(unbounded), (Checked{response} - work(k)).value_or(unbounded));
    if (place != nullptr) *place = latest;
    return latest;
  }
  /// What one release of task k takes from the task: the interrupt; all of it if it goes before.
  [[nodiscard]] constexpr Checked each(std::size_t k) const noexcept {
    if (k != index_ && tasks_[k].level <= tasks_[index_].level) return taken(k) + processor_.interrupt;
    return processor_.interrupt;
  }
  /// What task k takes of `window` ticks.
  [[nodiscard]] constexpr Checked share(std::size_t k, Checked window) const noexcept {
    if (processor_.interrupt == 0 && (k == index_ || tasks_[k].level > tasks_[index_].level)) return 0;
    return ceil_div(window + lateness(k), tasks_[k].period) * each(k);
  }
  [[nodiscard]] constexpr Checked ticks(Checked window) const noexcept {
    return processor_.tick_period == 0 ? Checked{0}
                                       : ceil_div(window, processor_.tick_period) * processor_.tick_cost;
  }
  [[nodiscard]] constexpr Checked interference(Checked window) const noexcept {
    Checked sum = ticks(window);
    if (processor_.interrupt == 0) {  // nearly all terms of nearly all analyses: only who goes before
      const std::uint32_t level = tasks_[index_].level;
      for (std::size_t k = 0; k < tasks_.size(); ++k)
        if (tasks_[k].level <= level && k != index_)
          sum += ceil_div(window + lateness(k), tasks_[k].period) * taken(k);
      return sum;
    }
    for (std::size_t k = 0; k < tasks_.size(); ++k) sum += share(k, window);
    return sum;
  }

  /// How much of the processor all ask for that delays the task, less its own cost; in 31 binary digits, up
  /// to 2 in the last place for each task below the truth. Saturates at 2.
  [[nodiscard]] constexpr std::uint64_t quick_load() const noexcept {
    std::uint64_t sum = quick(processor_.tick_cost, processor_.tick_period);
    for (std::size_t k = 0; k < tasks_.size(); ++k) sum = quick_add(sum, each(k), tasks_[k].period);
    return sum;
  }
  [[nodiscard]] constexpr std::uint64_t quick_own() const noexcept {
    return quick_add(0, cost(index_), tasks_[index_].period);
  }
  static constexpr std::uint64_t quick_one = std::uint64_t{1} << 31U;

  /// No end is before this: `work` of its own, while the others take their part of all the time that it
  /// needs.
  [[nodiscard]] static constexpr Checked earliest(Checked work, std::uint64_t others) noexcept {
    if (!work.ok() || work.value() >> 32U != 0 || others >= quick_one) return work;
    return static_cast<std::int64_t>((static_cast<std::uint64_t>(work.value()) << 31U) /
                                     (quick_one - others));
  }

  /// The same, exactly.
  [[nodiscard]] constexpr Utilisation load() const noexcept {
    Utilisation sum;
    if (processor_.tick_period > 0) sum.add(processor_.tick_cost, processor_.tick_period);
    for (std::size_t k = 0; k < tasks_.size(); ++k)
      sum.add(own_or_each(k).value_or(unbounded), tasks_[k].period);
    return sum;
  }
  /// Who asks for the most of it.
  [[nodiscard]] constexpr std::size_t greatest_load() const noexcept {
    std::size_t greatest = index_;
    std::uint64_t most = 0;
    for (std::size_t k = 0; k < tasks_.size(); ++k) {
      const std::uint64_t load = quick_add(0, own_or_each(k), tasks_[k].period);
      if (load > most) {
        greatest = k;
        most = load;
      }
    }
    return greatest;
  }
  /// With a load of exactly 1 a busy period ends only if nothing comes late and nothing blocks.
  [[nodiscard]] constexpr bool punctual() const noexcept {
    if (!(blocking() == 0)) return false;
    for (std::size_t k = 0; k < tasks_.size(); ++k)
      if (!(lateness(k) == 0) && !(own_or_each(k) == 0)) return false;
    return true;
  }

 private:
  [[nodiscard]] constexpr Checked own_or_each(std::size_t k) const noexcept {
    return k == index_ ? cost(k) + processor_.interrupt : each(k);
  }
  static constexpr std::uint64_t quick(std::int64_t cost, std::int64_t period) noexcept {
    if (cost == 0) return 0;  // without a tick there is no period, either
    auto part = static_cast<std::uint64_t>(cost);
    auto whole = static_cast<std::uint64_t>(period);
    if (part >= 2 * whole) return 2 * quick_one;
    if (part >> 33U != 0) {  // rounded so that the quotient is not above the truth
      whole = (whole >> 31U) + 1;
      part >>= 31U;
    }
    return (part << 31U) / whole;
  }
  static constexpr std::uint64_t quick_add(std::uint64_t sum, Checked cost, std::int64_t period) noexcept {
    return std::min(sum + quick(cost.value_or(unbounded), period), 2 * quick_one);
  }

  std::span<const Task> tasks_;
  std::size_t index_;
  const Processor& processor_;
  LateWork& late_;
};

/// Stops at the first instance that is late if `only_verdict`: then there is no response, only a reason.
constexpr Explained response_time(std::span<const Task> tasks, std::size_t index, const Processor& processor,
                                  Limits limits, std::span<std::int64_t> instances,
                                  std::span<std::int64_t> shares, bool only_verdict,
                                  LateWork& late) noexcept {
  Explained result;
  if (index >= tasks.size() || !processor.valid()) return result;
  const Task& task = tasks[index];
  result.deadline = task.due();
  result.largest = first_invalid(tasks);
  if (result.largest != no_index) return result;

  const ProcessorDemand demand{tasks, index, processor, late};
  const Checked cost = demand.cost(index);
  const Checked jitter = demand.jitter(index);
  const Checked blocking = demand.blocking();
  result.blocked_by = task.blocking > 0 ? task.blocked_by : no_index;
  result.blocking = blocking.value_or(unbounded);

  // The load is below 1, or the busy period does not end. A quick sum decides nearly always.
  const std::uint64_t others = demand.quick_load();
  if (others + demand.quick_own() + 2 * (tasks.size() + 2) >= demand.quick_one) {
    const Comparison load = demand.load().versus_one();
    if (load == Comparison::above || (load == Comparison::equal && !demand.punctual())) {
      result.reason = Reason::overloaded;
      result.largest = demand.greatest_load();
      return result;
    }
  }

  result.reason = Reason::too_long;
  const auto terms = static_cast<std::int64_t>(tasks.size());
  std::int64_t worst = 0;
  std::int64_t worst_window = 0;
  Checked window = demand.earliest(blocking + cost, others);
  for (std::int64_t q = 0;; ++q) {
    const Checked own = blocking + cost * q + cost;
    for (;;) {
      limits.terms -= terms;
      if (limits.terms < 0) return result;
      const Checked next = own + demand.interference(window);
      if (!next.ok()) return result;
      if (next == window) break;
      window = next;
    }
    const Checked response = window + jitter - Checked{task.period} * q;
    if (!response.ok()) return result;
    if (static_cast<std::size_t>(q) < instances.size())
      instances[static_cast<std::size_t>(q)] = response.value();
    result.instances = static_cast<std::size_t>(q) + 1;
    if (response.value() > worst) {
      worst = response.value();
      worst_window = window.value();
      result.instance = static_cast<std::size_t>(q);
    }
    if (only_verdict && worst > result.deadline) {
      result.reason = Reason::misses_deadline;
      return result;
    }
    if (response <= task.period) break;  // the busy period ends before the next release
    window += cost;
  }

  result.response = worst;
  result.reason = worst <= result.deadline ? Reason::schedulable : Reason::misses_deadline;
  result.interference = demand.ticks(worst_window).value();
  for (std::size_t k = 0; k < tasks.size(); ++k) {
    const std::int64_t share = demand.share(k, worst_window).value();
    if (k < shares.size()) shares[k] = share;
    result.interference += share;
    if (share > result.largest_share) {
      result.largest = k;
      result.largest_share = share;
    }
  }
  return result;
}

}  // namespace detail

/// The response time of `tasks[index]`, from its release as planned, and why. If there is room, `instances`
/// gets the response of each release of the busy period, and `shares` how long each task delays the worst of
/// them.
[[nodiscard]] constexpr Explained response_time(std::span<const Task> tasks, std::size_t index,
                                                const Processor& processor = {}, Limits limits = {},
                                                std::span<std::int64_t> instances = {},
                                                std::span<std::int64_t> shares = {}) noexcept {
  detail::LateWork late;
  return detail::response_time(tasks, index, processor, limits, instances, shares, false, late);
}

/// All of them; `results` has room for as many as it has. O(tasks^2) a step.
constexpr void response_times(std::span<const Task> tasks, std::span<Explained> results,
                              const Processor& processor = {}, Limits limits = {}) noexcept {
  for (std::size_t i = 0; i < tasks.size() && i < results.size(); ++i)
    results[i] = response_time(tasks, i, processor, limits);
}
template <std::size_t N>
[[nodiscard]] constexpr std::array<Explained, N> response_times(const std::array<Task, N>& tasks,
                                                                const Processor& processor = {},
                                                                Limits limits = {}) noexcept {
  std::array<Explained, N> results{};
  response_times(std::span<const Task>{tasks}, std::span<Explained>{results}, processor, limits);
  return results;
}

/// Whether this task meets its deadline, or why it is not known to: sooner done than the response time.
[[nodiscard]] constexpr Reason verdict(std::span<const Task> tasks, std::size_t index,
                                       const Processor& processor = {}, Limits limits = {}) noexcept {
  detail::LateWork late;
  return detail::response_time(tasks, index, processor, limits, {}, {}, true, late).reason;
}

/// The first task that is not known to meet its deadline; no_index: all do.
[[nodiscard]] constexpr std::size_t first_miss(std::span<const Task> tasks, const Processor& processor = {},
                                               Limits limits = {}) noexcept {
  for (std::size_t i = 0; i < tasks.size(); ++i)
    if (verdict(tasks, i, processor, limits) != Reason::schedulable) return i;
  return no_index;
}
/// Every task meets its deadline. False, too, where that could not be found out.
[[nodiscard]] constexpr bool all_schedulable(std::span<const Task> tasks, const Processor& processor = {},
                                             Limits limits = {}) noexcept {
  return first_miss(tasks, processor, limits) == no_index;
}

}  // namespace ocm::analysis
