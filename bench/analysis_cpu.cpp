/// What response times of tasks cost: all tasks of a set of 10 to 2048, once as bounds and once as a verdict
/// only.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

#include "ocm/analysis/assignment.hpp"
#include "ocm/analysis/sensitivity.hpp"
#include "ocm/analysis/task_response.hpp"

#include "bench/best_of.hpp"

using namespace ocm::analysis;
using ocm::bench::best_of;

namespace {

/// U 0.7, periods from 1 ms to 1 s with equally many of each magnitude, in nanoseconds, rate monotonic.
std::vector<Task> draw(std::size_t count) {
  std::mt19937_64 engine{count};
  std::uniform_real_distribution<double> uniform;
  std::vector<Task> tasks(count);
  double sum = 0;
  std::vector<double> parts(count);
  for (double& part : parts) sum += part = -std::log(1 - uniform(engine));
  for (std::size_t i = 0; i < count; ++i) {
    tasks[i].period = static_cast<std::int64_t>(1e6 * std::pow(1000.0, uniform(engine)));
    tasks[i].cost =
        1 + static_cast<std::int64_t>(0.7 * parts[i] / sum * static_cast<double>(tasks[i].period));
    tasks[i].jitter = tasks[i].period / 20;
  }
  rate_monotonic(tasks);
  return tasks;
}

}  // namespace

int main() {
  std::printf("%6s %18s %18s %18s\n", "tasks", "response times", "schedulable", "shortest period");
  for (const std::size_t count : {10, 100, 1000, 2048}) {
    std::vector<Task> tasks = draw(count);
    std::vector<Explained> results(count);
    const int times = count > 500 ? 3 : 50;
    const double all = best_of(times, [&] { response_times(tasks, results); });
    for (const Explained& result : results)
      if (!result.bounded()) return EXIT_FAILURE;
    bool met = false;
    const double verdicts = best_of(times, [&] { met = all_schedulable(tasks); });
    Edge edge;
    const double period = count > 500 ? NAN : best_of(3, [&] { edge = shortest_period(tasks, count / 2); });
    std::printf("%6zu %15.1f us %15.1f us", count, all, verdicts);
    std::isnan(period) ? std::printf(" %18s\n", "") : std::printf(" %15.1f us\n", period);
    if (met != std::all_of(results.begin(), results.end(), [](const Explained& e) { return e.ok(); }))
      return EXIT_FAILURE;
  }
}
