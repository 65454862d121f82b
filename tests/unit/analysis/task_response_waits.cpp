// Tasks that sleep while less urgent ones hold what they need, against a processor in ticks that knows no
// formula: what it plays is never longer than predicted, and longer than predicted by who forgets that a
// job's work can come later than its release.
#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/analysis/task_response.hpp"

#include "unit/base/explore.hpp"

namespace analysis_task_response_waits_test {

using namespace ocm::analysis;

/// What a job does, how long it sleeps, and what it does then.
struct Job {
  std::int64_t release = 0;
  std::int64_t before = 0, sleeps = 0, after = 0;
};

/// The longest response of each task. A job sleeps once, at any moment, and its work may be shorter than C -
/// W.
std::vector<std::int64_t> play(const std::vector<Task>& tasks, std::int64_t until, std::mt19937& random) {
  const auto up_to = [&random](std::int64_t most) {
    return std::uniform_int_distribution<std::int64_t>{0, most}(random);
  };
  const auto draw = [&](const Task& task, std::int64_t release) {
    const std::int64_t work = task.cost - task.waits;
    Job job{.release = release};
    const std::int64_t choice = up_to(3);
    job.sleeps = choice == 0 ? 0 : choice == 1 ? up_to(task.waits) : task.waits;
    job.before = up_to(1) == 0 ? 0 : up_to(work);
    job.after = work - job.before;
    return job;
  };
  std::vector<Job> jobs;
  for (const Task& task : tasks) jobs.push_back(draw(task, up_to(task.period)));
  std::vector<std::int64_t> longest(tasks.size(), 0);
  for (std::int64_t now = 0; now < until; ++now) {
    bool taken = false;  // in the order of their levels
    for (std::size_t k = 0; k < tasks.size(); ++k) {
      Job& job = jobs[k];
      if (job.release > now) continue;
      if (job.before > 0) {
        if (taken) continue;
        taken = true;
        --job.before;
      } else if (job.sleeps > 0) {
        --job.sleeps;
      } else if (job.after > 0) {
        if (taken) continue;
        taken = true;
        --job.after;
      }
      if (job.before + job.sleeps + job.after > 0) continue;
      longest[k] = std::max(longest[k], now + 1 - job.release);
      job = draw(tasks[k], std::max(now + 1, job.release + tasks[k].period + (up_to(2) == 0 ? up_to(3) : 0)));
    }
  }
  return longest;
}

/// The bound of who forgets S.
std::int64_t forgets(const std::vector<Task>& tasks, std::size_t index) {
  std::int64_t window = 0, next = tasks[index].cost;
  while (next != window) {
    window = next;
    next = tasks[index].cost;
    for (std::size_t k = 0; k < index; ++k)
      next += (window + tasks[k].period - 1) / tasks[k].period * (tasks[k].cost - tasks[k].waits);
  }
  return window;
}

TEST_CASE("Tasks that wait: what is played is never longer than predicted, without S it is") {
  std::mt19937 random{7};
  int sets = 0, reached = 0, longer_without = 0;
  for (const int wanted = ocm::test::explored(2'000); sets < wanted;) {
    std::vector<Task> tasks(static_cast<std::size_t>(std::uniform_int_distribution{2, 4}(random)));
    for (std::size_t k = 0; k < tasks.size(); ++k) {
      Task& task = tasks[k];
      task.level = static_cast<std::uint32_t>(k);
      task.period = std::uniform_int_distribution<std::int64_t>{8, 60}(random);
      task.cost =
          std::uniform_int_distribution<std::int64_t>{1, std::max<std::int64_t>(1, task.period / 2)}(random);
      task.waits = std::uniform_int_distribution<std::int64_t>{0, task.cost - 1}(random);
    }
    if (!all_schedulable(tasks)) continue;
    ++sets;
    const auto longest = play(tasks, 5'000, random);
    for (std::size_t k = 0; k < tasks.size(); ++k) {
      const std::int64_t bound = response_time(tasks, k).response;
      if (longest[k] > bound)
        FAIL("task " << k << " of " << tasks.size() << ": " << longest[k] << " and not " << bound);
      if (k > 0 && longest[k] == bound) ++reached;
      if (longest[k] > forgets(tasks, k)) ++longer_without;
    }
  }
  INFO("reached " << reached << ", longer than without S " << longer_without);
  CHECK(reached > sets / 10);
  CHECK(longer_without > 0);
}

/// Each does 1 of 2 ticks and sleeps for the other, every 3 N: so that all of them fit, and none of the first
/// is late.
template <std::size_t N>
constexpr std::array<Task, N> waiting() {
  std::array<Task, N> tasks{};
  for (std::size_t k = 0; k < N; ++k)
    tasks[k] = {.cost = 2, .period = 3 * N, .level = static_cast<std::uint32_t>(k), .waits = 1};
  return tasks;
}
/// By hand: C_0 = 2, and each that goes before takes 1: R_k = 2 + k. None comes twice: it is R_k - 1 late at
/// most.
static_assert(response_time(waiting<12>(), 0).response == 2);
static_assert(response_time(waiting<12>(), 11).response == 2 + 11);

TEST_CASE("Tasks that wait: many of them are looked at once each") {
  // 2^39 analyses otherwise, one for each way down through the levels.
  const auto tasks = waiting<40>();
  CHECK(response_time(tasks, 16).response == 2 + 16);
  // Sixteen are known; the others may be as late as their deadline, 120 - 1: those that come twice within the
  // window are the 39 - 16 of them.
  CHECK(response_time(tasks, 39).response == 2 + 39 + (39 - 16));
  CHECK(all_schedulable(tasks));
}

}  // namespace analysis_task_response_waits_test
