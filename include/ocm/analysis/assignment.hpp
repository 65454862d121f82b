/// Audsley's optimal assignment of priorities: if any order of the set meets all deadlines, this finds one;
/// at most n(n + 1)/2 tests. [Audsley 2001]
///
///     std::array tasks{Task{52, 100, 110}, Task{52, 140, 154}};
///     if (optimal_levels(tasks).ok()) ...   // levels are set; neither monotonic order would do
///
/// Optimal for every test in which who is more urgent matters, and their order does not: response times with
/// jitter and arbitrary deadlines, with a B that is given or that follows from a table of sections, messages
/// on CAN. No heap. Candidates for a level are tried from the end of the set on: in deadline-monotonic order
/// the result stays as near to that as it can.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/analysis/blocking.hpp"
#include "ocm/analysis/task_response.hpp"
#include "ocm/analysis/task_set.hpp"
#include "ocm/analysis/verdict.hpp"

namespace ocm::analysis {

struct Assignment {
  Reason reason = Reason::schedulable;  ///< or why the last one tried does not fit the level
  std::size_t placed = 0;               ///< how many have their level, from the least urgent
  std::size_t stuck = no_index;         ///< one that does not fit the next level; nor does any other
  [[nodiscard]] constexpr bool ok() const noexcept { return reason == Reason::schedulable; }
  friend bool operator==(const Assignment&, const Assignment&) = default;
};

/// For anything that has a `level`. `test(index)` says whether items[index] meets its deadline, as a Reason,
/// where items of the same level count as more urgent. On failure those that have no level share the one that
/// none of them fits.
template <class Item, class Test>
constexpr Assignment optimal_levels(std::span<Item> items, Test test) noexcept {
  Assignment result;
  for (Item& item : items) item.level = static_cast<std::uint32_t>(items.size() - 1);
  for (std::size_t left = items.size(); left > 0; --left) {
    const auto level = static_cast<std::uint32_t>(left - 1);
    std::size_t fits = no_index;
    for (std::size_t i = items.size(); i-- > 0 && fits == no_index;) {
      if (items[i].level != level) continue;  // has its own already
      result.reason = test(i);
      result.stuck = i;
      if (result.reason == Reason::schedulable) fits = i;
    }
    if (fits == no_index) return result;
    ++result.placed;
    result.stuck = no_index;
    for (std::size_t i = 0; i < items.size(); ++i)
      if (items[i].level == level && i != fits) items[i].level = level - 1;
  }
  return result;
}

/// With each task's B as it is.
constexpr Assignment optimal_levels(std::span<Task> tasks, const Processor& processor = {},
                                    Limits limits = {}) noexcept {
  return optimal_levels(tasks, [&](std::size_t i) { return verdict(tasks, i, processor, limits); });
}

/// With B from a table of sections, which depends on the levels. Scratch: as set_blocking; a table that is
/// not good is bad_input.
constexpr Assignment optimal_levels(std::span<Task> tasks, std::span<const Section> sections,
                                    Protocol protocol, std::span<std::uint32_t> scratch,
                                    const Processor& processor = {}, Limits limits = {}) noexcept {
  const auto with_sections = [&](std::size_t i) {
    if (set_blocking(tasks, sections, protocol, scratch) != Table::good) return Reason::bad_input;
    return verdict(tasks, i, processor, limits);
  };
  const Assignment result = optimal_levels(tasks, with_sections);
  if (result.ok()) (void)set_blocking(tasks, sections, protocol, scratch);
  return result;
}

}  // namespace ocm::analysis
