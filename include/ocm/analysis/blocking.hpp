/// How long a task can be held up by less urgent ones that have a resource: B, from a table of critical
/// sections, under priority inheritance and under a priority ceiling. [Sha, Rajkumar, Lehoczky 1990; Baker
/// 1991]
///
///     constexpr std::array sections{Section{.task = 2, .resource = i2c, .length = 40}, Section{0, i2c, 15}};
///     constexpr auto tasks = with_blocking(in_order(std::array{...}), sections, Protocol::inheritance);
///
/// A section can hold up level i if its task is less urgent than i, and a task at i or above uses the
/// resource. Inheritance: one section of each such task, and of each such resource, at most, so the lesser of
/// the two sums. Ceiling (a holder runs at its resource's ceiling from the moment of the claim): one section
/// in all. Sections may nest: a row names the one that it lies inside. With inheritance, who waits inside a
/// section hands on what it inherits, so a resource's ceiling counts for what is claimed inside it, too; and
/// resources that are nested in two orders can deadlock, which is refused. A job claims a resource that a
/// more urgent one may need only between its start and its end: no section spans jobs.
///
/// No heap: the caller gives one number a section of scratch. O(sections^2), with nesting O(sections^3).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>

#include "ocm/analysis/checked.hpp"
#include "ocm/analysis/task_set.hpp"
#include "ocm/analysis/verdict.hpp"

namespace ocm::analysis {

/// One stretch of a job in which it has a resource, at its longest.
struct Section {
  std::size_t task = 0;           ///< whose, in the set
  std::uint32_t resource = 0;     ///< any number
  std::int64_t length = 0;        ///< longest time of it, sections inside included
  std::size_t inside = no_index;  ///< the row of the section of the same job around it: an earlier one
};

/// How a resource that is taken is kept from holding up those who do not use it.
enum class Protocol : std::uint8_t { inheritance, ceiling };

/// Why a table of sections cannot be used.
enum class Table : std::uint8_t {
  good,
  no_such_task,  ///< a row names a task that the set does not have
  bad_length,    ///< negative, or longer than what is around it, or than its job
  bad_nesting,   ///< inside itself, a later row, or another task's
  deadlock,      ///< two resources are claimed inside each other
  no_room,       ///< the scratch has fewer numbers than there are rows
};

void the_table_of_sections_is_not_good();  // is never defined: names the mistake in a constant expression

[[nodiscard]] constexpr std::string_view describe(Table table) noexcept {
  switch (table) {
    case Table::good:
      return "a table that can be used";
    case Table::no_such_task:
      return "a section of a task that the set does not have";
    case Table::bad_length:
      return "a section that is longer than its job or than the section around it, or negative";
    case Table::bad_nesting:
      return "a section inside one of another task, of the same resource, or of a later row";
    case Table::deadlock:
      return "resources that are claimed inside each other: a deadlock under priority inheritance";
    case Table::no_room:
      return "less scratch than sections";
  }
  return "unknown";
}

/// B of one level.
struct Blocking {
  std::int64_t time = 0;
  std::size_t sections = 0;        ///< how many can follow each other
  std::size_t by = no_index;       ///< the task that has the longest of them
  std::size_t section = no_index;  ///< its row
};

namespace detail {

/// Gives `value` to all rows of one resource.
constexpr void for_resource(std::span<const Section> sections, std::uint32_t resource,
                            std::span<std::uint32_t> values, std::uint32_t value) noexcept {
  for (std::size_t s = 0; s < sections.size(); ++s)
    if (sections[s].resource == resource) values[s] = value;
}

constexpr Table check_rows(std::span<const Task> tasks, std::span<const Section> sections) noexcept {
  for (std::size_t s = 0; s < sections.size(); ++s) {
    const Section& row = sections[s];
    if (row.task >= tasks.size()) return Table::no_such_task;
    if (row.length < 0 || row.length > tasks[row.task].cost) return Table::bad_length;
    if (row.inside == no_index) continue;
    if (row.inside >= s || sections[row.inside].task != row.task) return Table::bad_nesting;
    if (sections[row.inside].length < row.length) return Table::bad_length;
    for (std::size_t around = row.inside; around != no_index; around = sections[around].inside)
      if (sections[around].resource == row.resource) return Table::bad_nesting;
  }
  return Table::good;
}

/// Whether resources can be numbered so that each is claimed inside lower numbers only: no deadlock.
constexpr bool can_be_ordered(std::span<const Section> sections, std::span<std::uint32_t> depth) noexcept {
  for (std::size_t s = 0; s < sections.size(); ++s) depth[s] = 0;
  for (std::size_t round = 0; round <= sections.size(); ++round) {
    bool changed = false;
    for (const Section& row : sections) {
      if (row.inside == no_index) continue;
      const auto own = static_cast<std::size_t>(&row - sections.data());
      if (depth[own] > depth[row.inside]) continue;
      for_resource(sections, row.resource, depth, depth[row.inside] + 1);
      changed = true;
    }
    if (!changed) return true;
  }
  return false;
}

/// `above` gets for each row the most urgent level that its resource can hold up.
constexpr void set_ceilings(std::span<const Task> tasks, std::span<const Section> sections, Protocol protocol,
                            std::span<std::uint32_t> above) noexcept {
  for (std::size_t s = 0; s < sections.size(); ++s) {
    above[s] = tasks[sections[s].task].level;
    for (const Section& other : sections)
      if (other.resource == sections[s].resource) above[s] = std::min(above[s], tasks[other.task].level);
  }
  if (protocol == Protocol::ceiling) return;  // who has a resource never waits for one inside
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t s = 0; s < sections.size(); ++s) {
      const std::size_t around = sections[s].inside;
      if (around == no_index || above[around] >= above[s]) continue;
      for_resource(sections, sections[s].resource, above, above[around]);
      changed = true;
    }
  }
}

enum class Group : std::uint8_t { task, resource };

/// The rows that can hold up a level.
class Holders {
 public:
  constexpr Holders(std::span<const Task> tasks, std::span<const Section> sections,
                    std::span<const std::uint32_t> above, std::uint32_t level) noexcept
      : tasks_(tasks), sections_(sections), above_(above), level_(level) {}

  [[nodiscard]] constexpr bool holds(std::size_t s) const noexcept {
    return sections_[s].length > 0 && above_[s] <= level_ && tasks_[sections_[s].task].level > level_;
  }
  [[nodiscard]] constexpr std::size_t longest() const noexcept {
    std::size_t best = no_index;
    for (std::size_t s = 0; s < sections_.size(); ++s)
      if (holds(s) && (best == no_index || sections_[s].length > sections_[best].length)) best = s;
    return best;
  }
  /// The sum over all groups of the longest section of each, and how many groups there are.
  constexpr void sum(Group group, Checked& time, std::size_t& count) const noexcept {
    for (std::size_t s = 0; s < sections_.size(); ++s) {
      if (!holds(s) || !longest_of_group(s, group)) continue;
      time += sections_[s].length;
      ++count;
    }
  }

 private:
  [[nodiscard]] constexpr bool longest_of_group(std::size_t s, Group group) const noexcept {
    for (std::size_t other = 0; other < sections_.size(); ++other) {
      const bool same = group == Group::task ? sections_[other].task == sections_[s].task
                                             : sections_[other].resource == sections_[s].resource;
      if (!same || other == s || !holds(other)) continue;
      if (sections_[other].length > sections_[s].length) return false;
      if (sections_[other].length == sections_[s].length && other < s) return false;
    }
    return true;
  }

  std::span<const Task> tasks_;
  std::span<const Section> sections_;
  std::span<const std::uint32_t> above_;
  std::uint32_t level_;
};

/// Of a task at `level`. The number saturates at what 63 bits hold.
constexpr Blocking blocking(std::span<const Task> tasks, std::span<const Section> sections,
                            std::span<const std::uint32_t> above, Protocol protocol,
                            std::uint32_t level) noexcept {
  const Holders holders{tasks, sections, above, level};
  Blocking result;
  result.section = holders.longest();
  if (result.section == no_index) return result;
  result.by = sections[result.section].task;
  result.time = sections[result.section].length;
  result.sections = 1;
  if (protocol == Protocol::ceiling) return result;
  Checked by_task;
  Checked by_resource;
  std::size_t tasks_that_hold = 0;
  std::size_t resources_held = 0;
  holders.sum(Group::task, by_task, tasks_that_hold);
  holders.sum(Group::resource, by_resource, resources_held);
  const bool tasks_less = !(by_resource < by_task);
  result.time = (tasks_less ? by_task : by_resource).value_or(unbounded);
  result.sections = std::min(tasks_that_hold, resources_held);
  return result;
}
}  // namespace detail

/// B of a level, explained; after `set_blocking` of the same set, with its scratch.
[[nodiscard]] constexpr Blocking blocking_of(std::span<const Task> tasks, std::span<const Section> sections,
                                             std::span<const std::uint32_t> scratch, Protocol protocol,
                                             std::uint32_t level) noexcept {
  return detail::blocking(tasks, sections, scratch, protocol, level);
}

/// Sets B, who it is of, and with inheritance the context switches of waiting, in every task of the set. The
/// scratch has a number for each section. Task::switches is set again. Anything but Table::good: the tasks
/// are as before.
[[nodiscard]] constexpr Table set_blocking(std::span<Task> tasks, std::span<const Section> sections,
                                           Protocol protocol, std::span<std::uint32_t> scratch) noexcept {
  if (scratch.size() < sections.size()) return Table::no_room;
  if (const Table table = detail::check_rows(tasks, sections); table != Table::good) return table;
  if (protocol == Protocol::inheritance && !detail::can_be_ordered(sections, scratch)) return Table::deadlock;
  detail::set_ceilings(tasks, sections, protocol, scratch);
  for (Task& task : tasks) {
    task.switches = 2;
    const Blocking blocking = detail::blocking(tasks, sections, scratch, protocol, task.level);
    task.blocking = blocking.time;
    task.blocked_by = blocking.by;
  }
  if (protocol == Protocol::inheritance)  // each claim can wait once: away, and back
    for (const Section& section : sections) tasks[section.task].switches += 2;
  return Table::good;
}

/// A copy of the set with B from the table. What is wrong with a table that is not good is not said: a
/// constant expression does not compile then.
template <std::size_t N, std::size_t S>
[[nodiscard]] consteval std::array<Task, N> with_blocking(std::array<Task, N> tasks,
                                                          const std::array<Section, S>& sections,
                                                          Protocol protocol) {
  std::array<std::uint32_t, S> scratch{};
  if (set_blocking(tasks, sections, protocol, scratch) != Table::good) the_table_of_sections_is_not_good();
  return tasks;
}

}  // namespace ocm::analysis
