/// A set of tasks on one processor with fixed priorities and preemption, as the literature has it: each task
/// is released once a period at most, may be released late by its jitter, and suspends itself for W at most.
///
///     constexpr auto tasks = in_order(std::array{Task{.cost = 12, .period = 50}, Task{10, 40, 35}});
///
/// All times are ticks of the caller. Levels are those of `scheduling`: a lower number is more urgent, and
/// tasks of one level delay each other (in any order, without preemption or with: the bounds hold for each).
/// Symbols of [Burns, Wellings 2006, chapter 11] stand with the fields. Plain values, no heap.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/analysis/checked.hpp"
#include "ocm/analysis/verdict.hpp"

namespace ocm::analysis {

struct Task {
  std::int64_t cost = 0;                      ///< C: longest time that a job needs the processor; at least 1
  std::int64_t period = 0;                    ///< T: shortest distance of two releases as planned; at least 1
  std::int64_t deadline = implicit_deadline;  ///< D, from the release as planned; at least 1; may exceed T
  std::int64_t jitter = 0;                    ///< J: how much later than planned it may be released
  std::int64_t blocking = 0;                  ///< B: how long less urgent tasks can hold it up (blocking.hpp)
  std::uint32_t level = 0;                    ///< lower: more urgent
  std::uint32_t switches = 2;         ///< context switches a job causes: to it and back, and each wait
  std::size_t blocked_by = no_index;  ///< whose section B is, for the explanation
  /// W: how much of C it sleeps at most because less urgent tasks hold what it needs. They go on meanwhile,
  /// so that it takes only C - W from them.
  std::int64_t waits = 0;

  [[nodiscard]] constexpr std::int64_t due() const noexcept {
    return deadline == implicit_deadline ? period : deadline;
  }
  [[nodiscard]] constexpr bool valid() const noexcept {
    return cost > 0 && period > 0 && due() > 0 && jitter >= 0 && blocking >= 0 && waits >= 0 && waits < cost;
  }
  friend bool operator==(const Task&, const Task&) = default;
};

/// What the processor and its system take for themselves. The default is the processor of the text books.
struct Processor {
  std::int64_t context_switch = 0;  ///< a job pays Task::switches of them
  std::int64_t interrupt = 0;       ///< each release of each task, ahead of all levels
  std::int64_t lock = 0;            ///< longest stretch with interrupts off: one adds to each B
  std::int64_t tick_cost = 0;       ///< the system's periodic tick, ahead of all levels
  std::int64_t tick_period = 0;     ///< 0: there is none
  bool released_by_tick = false;    ///< releases are noticed at ticks only: a tick period more jitter
  /// C and B are these parts per million of what the tasks say: 2'000'000 is a processor of half the speed.
  std::int64_t scale = 1'000'000;

  [[nodiscard]] constexpr bool valid() const noexcept {
    return context_switch >= 0 && interrupt >= 0 && lock >= 0 && tick_cost >= 0 && tick_period >= 0 &&
           (tick_period > 0 || (tick_cost == 0 && !released_by_tick)) && scale > 0;
  }
};

/// The index of the first task whose numbers mean nothing; no_index if all do.
[[nodiscard]] constexpr std::size_t first_invalid(std::span<const Task> tasks) noexcept {
  for (std::size_t i = 0; i < tasks.size(); ++i)
    if (!tasks[i].valid()) return i;
  return no_index;
}

/// Each task a level of its own, the first the most urgent.
template <std::size_t N>
[[nodiscard]] constexpr std::array<Task, N> in_order(std::array<Task, N> tasks) noexcept {
  for (std::size_t i = 0; i < N; ++i) tasks[i].level = static_cast<std::uint32_t>(i);
  return tasks;
}

/// Levels by `key(task)`, the least the most urgent; of equal ones the first in the set. O(n^2).
template <class Key>
constexpr void set_levels(std::span<Task> tasks, Key key) noexcept {
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    std::uint32_t level = 0;
    for (std::size_t k = 0; k < tasks.size(); ++k)
      if (key(tasks[k]) < key(tasks[i]) || (k < i && key(tasks[k]) == key(tasks[i]))) ++level;
    tasks[i].level = level;
  }
}
/// The shorter the period, the more urgent: optimal where D = T and no task blocks another.
constexpr void rate_monotonic(std::span<Task> tasks) noexcept {
  set_levels(tasks, [](const Task& task) { return task.period; });
}
/// The shorter the deadline, the more urgent: optimal where D <= T and J = 0. Otherwise see assignment.hpp.
constexpr void deadline_monotonic(std::span<Task> tasks) noexcept {
  set_levels(tasks, [](const Task& task) { return task.due(); });
}
template <std::size_t N>
[[nodiscard]] constexpr std::array<Task, N> rate_monotonic(std::array<Task, N> tasks) noexcept {
  rate_monotonic(std::span<Task>{tasks});
  return tasks;
}
template <std::size_t N>
[[nodiscard]] constexpr std::array<Task, N> deadline_monotonic(std::array<Task, N> tasks) noexcept {
  deadline_monotonic(std::span<Task>{tasks});
  return tasks;
}

}  // namespace ocm::analysis
