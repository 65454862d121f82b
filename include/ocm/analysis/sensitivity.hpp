/// How far a set of tasks is from the edge: by how much all costs can grow, and of each task the greatest
/// cost, the shortest period, the greatest blocking and jitter with which the whole set still meets its
/// deadlines.
///
///     const Edge edge = shortest_period(tasks, 3);   // edge.value, and who misses one tick beyond
///
/// Each is a search by halves over the exact test, in whole ticks: at most 62 tests of the set. The response
/// times grow with every C, B and J and with every shorter T, so the edge is the only one. Where the analysis
/// finds no end within its limits, that counts as a miss. The set is changed while it is looked at, and is as
/// before at the end. B that comes from a table of sections stays as it is.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/analysis/checked.hpp"
#include "ocm/analysis/task_response.hpp"
#include "ocm/analysis/task_set.hpp"
#include "ocm/analysis/verdict.hpp"

namespace ocm::analysis {

struct Edge {
  bool exists = false;             ///< false: no value at all makes the set schedulable
  std::int64_t value = 0;          ///< the last one that does
  std::size_t missing = no_index;  ///< who misses at the next one, or at all; no_index: no limit was found
  friend bool operator==(const Edge&, const Edge&) = default;
};

/// No edge is looked for beyond: 36 years of nanoseconds; a processor a million times as slow.
inline constexpr std::int64_t longest_looked_for = std::int64_t{1} << 60U;
inline constexpr std::int64_t greatest_scale = 1'000'000'000'000;

namespace detail {

/// The last value from `good` on towards `bad`, both included, at which misses(value) says no_index. Whatever
/// is farther than one that misses, misses.
template <class Misses>
constexpr Edge find_edge(std::int64_t good, std::int64_t bad, Misses misses) noexcept {
  Edge edge;
  edge.missing = misses(good);
  if (edge.missing != no_index) return edge;
  edge.exists = true;
  edge.value = bad;
  edge.missing = misses(bad);
  if (edge.missing == no_index) return edge;
  while (bad - good > 1 || good - bad > 1) {
    const std::int64_t middle = good + (bad - good) / 2;
    const std::size_t who = misses(middle);
    (who == no_index ? good : bad) = middle;
    if (who != no_index) edge.missing = who;
  }
  edge.value = good;
  return edge;
}

/// Of one field of one task.
constexpr Edge edge_of(std::span<Task> tasks, std::size_t index, std::int64_t Task::*field, std::int64_t good,
                       std::int64_t bad, const Processor& processor, Limits limits) noexcept {
  const std::int64_t before = tasks[index].*field;
  const Edge edge = find_edge(good, bad, [&](std::int64_t value) {
    tasks[index].*field = value;
    return first_miss(tasks, processor, limits);
  });
  tasks[index].*field = before;
  return edge;
}

}  // namespace detail

/// The greatest C of tasks[index]; no task misses.
[[nodiscard]] constexpr Edge greatest_cost(std::span<Task> tasks, std::size_t index,
                                           const Processor& processor = {}, Limits limits = {}) noexcept {
  if (index >= tasks.size() || first_invalid(tasks) != no_index) return {false, 0, first_invalid(tasks)};
  const std::int64_t due = std::min(tasks[index].due(), longest_looked_for);
  const std::int64_t least = tasks[index].waits + 1;  // what it waits is a part of it
  return detail::edge_of(tasks, index, &Task::cost, least, std::max(due, least), processor, limits);
}
/// The greatest B.
[[nodiscard]] constexpr Edge greatest_blocking(std::span<Task> tasks, std::size_t index,
                                               const Processor& processor = {}, Limits limits = {}) noexcept {
  if (index >= tasks.size() || first_invalid(tasks) != no_index) return {false, 0, first_invalid(tasks)};
  const std::int64_t due = std::min(tasks[index].due(), longest_looked_for);
  return detail::edge_of(tasks, index, &Task::blocking, 0, due, processor, limits);
}
/// The greatest J.
[[nodiscard]] constexpr Edge greatest_jitter(std::span<Task> tasks, std::size_t index,
                                             const Processor& processor = {}, Limits limits = {}) noexcept {
  if (index >= tasks.size() || first_invalid(tasks) != no_index) return {false, 0, first_invalid(tasks)};
  const std::int64_t due = std::min(tasks[index].due(), longest_looked_for);
  return detail::edge_of(tasks, index, &Task::jitter, 0, due, processor, limits);
}
/// The shortest T. A deadline that is the period shrinks with it.
[[nodiscard]] constexpr Edge shortest_period(std::span<Task> tasks, std::size_t index,
                                             const Processor& processor = {}, Limits limits = {}) noexcept {
  if (index >= tasks.size() || first_invalid(tasks) != no_index) return {false, 0, first_invalid(tasks)};
  return detail::edge_of(tasks, index, &Task::period, longest_looked_for, 1, processor, limits);
}

/// The critical scaling factor in parts per million: all C and B may grow by that, each rounded up to whole
/// ticks. It replaces processor.scale. [Lehoczky, Sha, Ding 1989]
[[nodiscard]] constexpr Edge critical_scale(std::span<const Task> tasks, Processor processor = {},
                                            Limits limits = {}) noexcept {
  return detail::find_edge(1, greatest_scale, [&](std::int64_t scale) {
    processor.scale = scale;
    return first_miss(tasks, processor, limits);
  });
}

}  // namespace ocm::analysis
