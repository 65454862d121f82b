#include "ocm/analysis/sensitivity.hpp"

#include <array>
#include <vector>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"

namespace analysis_sensitivity_test {

using namespace ocm::analysis;

// [Burns, Wellings 2006, process sets A and B]
constexpr auto set_b = rate_monotonic(std::array{Task{32, 80}, Task{5, 40}, Task{4, 16}});
constexpr auto set_a = rate_monotonic(std::array{Task{12, 50}, Task{10, 40}, Task{10, 30}});

template <class Search>
constexpr Edge edge(Search search, const std::array<Task, 3>& set, std::size_t index) {
  auto tasks = set;
  const Edge result = search(std::span<Task>{tasks}, index, Processor{}, Limits{});
  return tasks == set ? result : Edge{};  // as before
}
static_assert(edge(greatest_cost, set_b, 0) == Edge{true, 50, 0});      // 50 + 2 * 5 + 5 * 4 = 80, at U = 1
static_assert(edge(greatest_blocking, set_b, 2) == Edge{true, 12, 2});  // D - C
static_assert(edge(greatest_jitter, set_b, 2) == Edge{true, 12, 2});
// Set A misses; it would not with ten of cost, or if the others came less often.
static_assert(edge(greatest_cost, set_a, 0) == Edge{true, 10, 0});
static_assert(edge(greatest_blocking, set_a, 0) == Edge{false, 0, 0});
static_assert(edge(shortest_period, set_a, 0) == Edge{true, 52, 0});
static_assert(edge(greatest_cost, set_a, 3) == Edge{false, 0, no_index});
static_assert(edge(greatest_blocking, set_a, 3) == Edge{false, 0, no_index});
static_assert(edge(greatest_jitter, set_a, 3) == Edge{false, 0, no_index});
static_assert(edge(shortest_period, set_a, 3) == Edge{false, 0, no_index});
constexpr auto invalid = in_order(std::array{Task{1, 9}, Task{1, 9}, Task{1, 0}});
static_assert(edge(greatest_cost, invalid, 0) == Edge{false, 0, 2} &&
              edge(greatest_blocking, invalid, 0) == Edge{false, 0, 2} &&
              edge(greatest_jitter, invalid, 0) == Edge{false, 0, 2});
static_assert(edge(shortest_period, in_order(std::array{Task{1, 9}, Task{1, 0}, Task{1, 9}}), 0) ==
              Edge{false, 0, 1});

// A task that waits needs more than it waits, and may grow to its deadline.
constexpr auto waiting = [] {
  auto set = rate_monotonic(std::array{Task{32, 80}, Task{5, 40}, Task{4, 16}});
  set[2].waits = 3;
  return set;
}();
static_assert(edge(greatest_cost, waiting, 2).exists && edge(greatest_cost, waiting, 2).value > 4);
constexpr Edge alone(Task task) {
  std::array tasks{task};
  return greatest_cost(tasks, 0);
}
static_assert(alone(Task{.cost = 10, .period = 20, .waits = 6}) == Edge{true, 20, no_index});
static_assert(alone(Task{.cost = 19, .period = 20, .waits = 18}) == Edge{true, 20, no_index});
static_assert(!alone(Task{.cost = 30, .period = 20, .waits = 25}).exists);

// At U = 1 nothing can grow.
constexpr auto set_c = rate_monotonic(std::array{Task{40, 80}, Task{10, 40}, Task{5, 20}});
static_assert(critical_scale(set_c) == Edge{true, 1'000'000, 0});
static_assert(critical_scale(in_order(std::array{Task{10, 40}, Task{20, 80}})).value == 2'000'000);
static_assert(critical_scale(in_order(std::array{Task{10, 40, 40, 40}})) == Edge{false, 0, 0});
// The search ends at a processor a million times as slow, in parts per million, and at 36 years of
// nanoseconds.
static_assert(critical_scale(in_order(std::array{Task{1, longest_looked_for * 4}})) ==
              Edge{true, 1'000'000'000'000, no_index});
static_assert(longest_looked_for == 1'152'921'504'606'846'976);

TEST_CASE("one tick beyond an edge a task misses") {
  ocm::test::Random random{6};
  int edges = 0;
  for (int i = 0; i < 500; ++i) {
    std::vector<Task> tasks(4);
    for (Task& task : tasks) {
      task.period = random.within(10, 1000);
      task.cost = random.within(1, 1 + static_cast<int>(task.period) / 3);
      if (random.below(2) == 0)
        task.deadline = random.within(static_cast<int>(task.period) / 2, 2 * static_cast<int>(task.period));
      task.jitter = random.within(0, 1) * random.within(0, static_cast<int>(task.period) / 4);
      task.blocking = random.within(0, 5);
    }
    deadline_monotonic(tasks);
    const Processor processor{.context_switch = random.within(0, 1), .interrupt = random.within(0, 1)};
    const std::size_t index = random.below(4);
    const auto holds = [&](Edge edge, std::int64_t Task::*field, int direction) {
      if (!edge.exists || edge.missing == no_index) return;
      ++edges;
      std::vector<Task> changed = tasks;
      changed[index].*field = edge.value;
      REQUIRE(all_schedulable(changed, processor));
      changed[index].*field = edge.value + direction;
      REQUIRE(first_miss(changed, processor) == edge.missing);
    };
    holds(greatest_cost(tasks, index, processor), &Task::cost, 1);
    holds(greatest_blocking(tasks, index, processor), &Task::blocking, 1);
    holds(greatest_jitter(tasks, index, processor), &Task::jitter, 1);
    holds(shortest_period(tasks, index, processor), &Task::period, -1);
    Processor scaled = processor;
    const Edge scale = critical_scale(tasks, processor);
    if (!scale.exists) continue;
    scaled.scale = scale.value;
    REQUIRE(all_schedulable(tasks, scaled));
    scaled.scale = scale.value + 1;
    REQUIRE_FALSE(all_schedulable(tasks, scaled));
    REQUIRE((scale.value >= 1'000'000) == all_schedulable(tasks, processor));
  }
  CHECK(edges > 1000);
}

}  // namespace analysis_sensitivity_test
