#include "ocm/analysis/task_list.hpp"
#include "ocm/analysis/task_sets.hpp"

#include "cli/analyse/set.hpp"

namespace ocm::cli::analyse {
namespace {

/// Levels count down from 0, the most urgent; priorities of a set count up.
template <class... Tasks>
TaskSet set_of(analysis::TaskList<Tasks...>) {
  TaskSet set;
  (set.entries.push_back(
       {std::string{Tasks::name}, -static_cast<std::int64_t>(Tasks::task.level), Tasks::task, 0}),
   ...);
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
