#include <algorithm>

#include "ocm/analysis/task_list.hpp"
#include "ocm/analysis/task_sets.hpp"

#include "cli/analyse/set.hpp"

namespace ocm::cli::analyse {
namespace {

/// Levels begin with 0, the most urgent; priorities of a set end with 1, the least urgent.
template <class... Tasks>
TaskSet set_of(analysis::TaskList<Tasks...>) {
  const std::int64_t levels = 1 + std::max({static_cast<std::int64_t>(Tasks::task.level)...});
  TaskSet set;
  (set.entries.push_back({std::string{Tasks::name}, levels - Tasks::task.level, Tasks::task}), ...);
  std::stable_sort(set.entries.begin(), set.entries.end(),
                   [](const TaskEntry& a, const TaskEntry& b) { return a.priority > b.priority; });
  return set;
}

}  // namespace

std::vector<std::string> own_task_sets() {
  std::vector<std::string> names;
  analysis::task_sets::for_each_set([&names](std::string_view name, auto) { names.emplace_back(name); });
  return names;
}

TaskSet own_tasks(std::string_view name) {
  TaskSet set;
  analysis::task_sets::for_each_set([&](std::string_view each, auto list) {
    if (each == name) set = set_of(list);
  });
  return set;
}

}  // namespace ocm::cli::analyse
