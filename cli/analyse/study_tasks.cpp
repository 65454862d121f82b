/// Task sets through the analysis of ocm/analysis/task_response.hpp.
#include <algorithm>

#include <fmt/format.h>

#include "ocm/analysis/assignment.hpp"
#include "ocm/analysis/sensitivity.hpp"
#include "ocm/analysis/task_response.hpp"

#include "cli/analyse/search.hpp"
#include "cli/analyse/study.hpp"

namespace ocm::cli::analyse {
namespace {

using analysis::Task;

/// Beyond, what each task could still do is not looked for: 124 tests of the set each.
constexpr std::size_t most_task_rooms = 40;

std::vector<Task> tasks_of(const TaskSet& set) {
  std::vector<Task> tasks;
  for (const TaskEntry& entry : set.entries) tasks.push_back(entry.task);
  return tasks;
}

/// What the processor takes for itself is in no C of the set, and the tests see nothing else.
bool takes_nothing(const analysis::Processor& processor) {
  return processor.context_switch == 0 && processor.interrupt == 0 && processor.lock == 0 &&
         processor.tick_period == 0;
}

std::vector<Study::QuickTest> quick_tests(const std::vector<Task>& tasks,
                                          const analysis::Processor& processor) {
  double sum = 0, product = 1;
  for (const Task& task : tasks) {
    const double load = static_cast<double>(task.cost) / static_cast<double>(task.period);
    sum += load;
    product *= load + 1;
  }
  const auto test = [&](std::string key, std::string title, double value, double bound,
                        analysis::Proof proof) {
    if (takes_nothing(processor))
      return Study::QuickTest{std::move(key),
                              std::move(title),
                              value,
                              bound,
                              proof == analysis::Proof::proven,
                              std::string{analysis::describe(proof)}};
    return Study::QuickTest{
        std::move(key), std::move(title), value, bound, false, "does not apply: the system takes time, too"};
  };
  const double liu_layland_bound = static_cast<double>(analysis::liu_layland_bound(tasks.size())) / 1'000'000;
  return {test("liu_layland", "Liu and Layland, sum of C/T", sum, liu_layland_bound,
               analysis::liu_layland(tasks)),
          test("hyperbolic", "hyperbolic, product of C/T + 1", product, 2, analysis::hyperbolic(tasks))};
}

}  // namespace

Study study_tasks(const TaskSet& set, const analysis::Processor& processor) {
  const std::vector<Task> tasks = tasks_of(set);
  Study study;
  study.kind = Study::Kind::tasks;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    std::vector<std::int64_t> instances(most_instances);
    const auto result = analysis::response_time(tasks, i, processor, {}, instances);
    instances.resize(result.bounded() ? std::min(result.instances, most_instances) : 0);
    study.load.add(tasks[i].cost, tasks[i].period);
    study.rows.push_back({set.entries[i].name,
                          std::to_string(set.entries[i].priority),
                          {},
                          tasks[i].cost,
                          tasks[i].period,
                          tasks[i].jitter,
                          result,
                          std::move(instances),
                          {},
                          0,
                          0,
                          false});
  }
  for (std::size_t i = 0; i < study.rows.size(); ++i) study.rows[i].why = explain(study, i);
  study.tests = quick_tests(tasks, processor);
  study.head = "fixed priorities, preemptive";
  if (processor.context_switch > 0)
    study.head += fmt::format(", {} a context switch", time_text(processor.context_switch));
  if (processor.interrupt > 0)
    study.head += fmt::format(", {} an interrupt for each release", time_text(processor.interrupt));
  if (processor.lock > 0)
    study.head += fmt::format(", interrupts off for {} at most", time_text(processor.lock));
  if (processor.tick_period > 0)
    study.head +=
        fmt::format(", a tick of {} every {}{}", time_text(processor.tick_cost),
                    time_text(processor.tick_period), processor.released_by_tick ? " that releases" : "");
  return study;
}

Advice advise_tasks(const TaskSet& set, const analysis::Processor& processor, const Study& study) {
  Advice advice;
  std::vector<Task> tasks = tasks_of(set);
  const bool passes = study.passes();
  if (tasks.size() <= most_task_rooms) {
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      const auto period = analysis::shortest_period(tasks, i, processor, quick);
      const auto cost = analysis::greatest_cost(tasks, i, processor, quick);
      advice.rooms.push_back({period.exists ? period.value : 0, cost.exists ? cost.value : 0});
      if (passes) continue;
      if (period.exists)
        advice.changes.push_back(fmt::format("{} every {} instead of every {}", set.entries[i].name,
                                             time_text(period.value), time_text(tasks[i].period)));
      if (cost.exists)
        advice.changes.push_back(fmt::format("{} in {} instead of {}", set.entries[i].name,
                                             time_text(cost.value), time_text(tasks[i].cost)));
    }
  }
  const auto scale = analysis::critical_scale(tasks, processor, quick);
  if (scale.exists && scale.value < analysis::greatest_scale)
    advice.changes.push_back(fmt::format("all costs {} {}.{:02} %", passes ? "could be" : "at",
                                         scale.value / 10'000, scale.value % 10'000 / 100));
  if (!passes && tasks.size() <= most_task_rooms) {
    std::vector<Task> other = tasks;
    if (analysis::optimal_levels(other, processor, quick).ok()) {
      std::string order;
      for (std::uint32_t level = 0; level < other.size(); ++level)
        for (std::size_t i = 0; i < other.size(); ++i)
          if (other[i].level == level) order += (order.empty() ? "" : ", ") + set.entries[i].name;
      advice.changes.push_back("priorities in this order: " + order);
    }
  }
  return advice;
}

}  // namespace ocm::cli::analyse
