#include "ocm/analysis/assignment.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"

namespace analysis_assignment_test {

using namespace ocm::analysis;

// D > T: the monotonic order, of rates and of deadlines, misses; the other one does not. [Lehoczky 1990]
constexpr std::array beyond{Task{52, 100, 110}, Task{52, 140, 154}};
static_assert(!all_schedulable(rate_monotonic(beyond)) && !all_schedulable(deadline_monotonic(beyond)));
static_assert([] {
  auto tasks = beyond;
  return optimal_levels(std::span<Task>{tasks}).ok() && tasks[1].level == 0 && tasks[0].level == 1 &&
         all_schedulable(tasks);
}());

// Jitter: the later deadline has less time left.
constexpr std::array late{Task{4, 100, 9, 0}, Task{4, 100, 12, 7}};
static_assert(!all_schedulable(deadline_monotonic(late)));
static_assert([] {
  auto tasks = late;
  return optimal_levels(std::span<Task>{tasks}).ok() && tasks[1].level == 0;
}());

// Where deadline-monotonic order does, it stays.
constexpr std::array easy{Task{1, 10}, Task{1, 20}, Task{1, 30}, Task{1, 40}};
static_assert([] {
  auto tasks = easy;
  return optimal_levels(std::span<Task>{tasks}).ok() && tasks == deadline_monotonic(easy);
}());

// None does: how many could be placed, and one that fits no more.
static_assert([] {
  std::array tasks{Task{6, 10}, Task{5, 10}, Task{1, 1000}};
  const Assignment result = optimal_levels(std::span<Task>{tasks});
  return !result.ok() && result.reason == Reason::overloaded && result.placed == 0;
}());
static_assert([] {
  std::array tasks{Task{3, 10, 5}, Task{3, 10, 5}, Task{1, 1000}};
  const Assignment result = optimal_levels(std::span<Task>{tasks});
  return result.reason == Reason::misses_deadline && result.placed == 1 && result.stuck == 0 &&
         tasks[2].level == 2;
}());
static_assert(optimal_levels(std::span<Task>{}).ok());
static_assert([] {
  std::array tasks{Task{3, 0}};
  return optimal_levels(std::span<Task>{tasks}).reason == Reason::bad_input;
}());

constexpr std::array sections{Section{0, 1, 1}, Section{2, 1, 6}};
static_assert([] {
  // With deadlines in this order task 2 would hold up task 0 beyond its deadline; so 2 goes first.
  std::array tasks{Task{4, 50, 9}, Task{4, 50, 19}, Task{7, 50, 20}};
  std::array<std::uint32_t, 2> scratch{};
  return optimal_levels(tasks, sections, Protocol::ceiling, scratch).reason == Reason::misses_deadline;
}());
static_assert([] {
  std::array tasks{Task{4, 50, 12}, Task{4, 50, 19}, Task{7, 50, 20}};
  std::array<std::uint32_t, 2> scratch{};
  return optimal_levels(tasks, sections, Protocol::ceiling, scratch).ok() && tasks[0].level == 0 &&
         tasks[0].blocking == 6;
}());
static_assert([] {
  std::array tasks{Task{4, 50}};
  return optimal_levels(tasks, sections, Protocol::ceiling, {}).reason == Reason::bad_input;
}());

TEST_CASE("it finds an order if and only if there is one") {
  ocm::test::Random random{5};
  int found = 0;
  int monotonic_misses = 0;
  for (int i = 0; i < 3000; ++i) {
    std::vector<Task> tasks(4);
    for (Task& task : tasks) {
      task.period = random.within(10, 100);
      task.cost = random.within(1, static_cast<int>(task.period) / 2);
      task.deadline = random.within(static_cast<int>(task.period) / 2, 2 * static_cast<int>(task.period));
      task.jitter = random.within(0, 1) * random.within(0, static_cast<int>(task.period) / 2);
      task.blocking = random.within(0, 3);
    }
    std::vector<Task> tried = tasks;
    std::array<std::uint32_t, 4> order{0, 1, 2, 3};
    bool exists = false;
    do {
      for (std::size_t k = 0; k < 4; ++k) tried[k].level = order[k];
      exists = exists || all_schedulable(tried);
    } while (std::next_permutation(order.begin(), order.end()));
    deadline_monotonic(tried);
    const bool monotonic = all_schedulable(tried);
    const bool optimal = optimal_levels(std::span<Task>{tasks}).ok();
    REQUIRE(optimal == exists);
    if (optimal) REQUIRE(all_schedulable(tasks));
    found += optimal ? 1 : 0;
    monotonic_misses += optimal && !monotonic ? 1 : 0;
  }
  CHECK(found > 300);
  CHECK(monotonic_misses > 30);  // the test would notice an assignment that is deadline monotonic
}

}  // namespace analysis_assignment_test
