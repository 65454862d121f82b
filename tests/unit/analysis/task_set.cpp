#include "ocm/analysis/task_set.hpp"

#include <limits>

#include <catch2/catch.hpp>

namespace analysis_task_set_test {

using namespace ocm::analysis;

constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();

static_assert(Task{1, 1}.valid() && Task{1, 1}.due() == 1 && Task{1, 10, 5}.due() == 5);
static_assert(Task{most, most, most, most, most}.valid());
static_assert(!Task{}.valid() && !Task{0, 1}.valid() && !Task{1, 0}.valid() && !Task{-1, 5}.valid());
static_assert(!Task{1, -5}.valid() && !Task{1, 5, 0}.valid() && !Task{1, 5, -1}.valid());
static_assert(!Task{1, 5, 5, -1}.valid() && !Task{1, 5, 5, 0, -1}.valid());

static_assert(!Task{.cost = 1, .period = 5, .waits = -1}.valid() &&
              !Task{.cost = 2, .period = 5, .waits = 2}.valid());
static_assert(Task{.cost = 2, .period = 5, .waits = 1}.valid());

static_assert(Processor{}.valid());
static_assert(!Processor{.tick_cost = -1, .tick_period = 1}.valid() && !Processor{.tick_period = -1}.valid());
static_assert(Processor{.tick_cost = 0, .tick_period = 1}.valid() && Processor{.scale = 1}.valid());
static_assert(!Processor{.context_switch = -1}.valid() && !Processor{.interrupt = -1}.valid());
static_assert(!Processor{.lock = -1}.valid() && !Processor{.scale = 0}.valid());
static_assert(!Processor{.tick_cost = 1}.valid() && !Processor{.released_by_tick = true}.valid());
static_assert(Processor{.tick_cost = 1, .tick_period = 10, .released_by_tick = true}.valid());

constexpr std::array mixed{Task{1, 50, 9}, Task{1, 20}, Task{1, 50, 30}, Task{1, 20, 40}};
static_assert(first_invalid(mixed) == no_index);
static_assert(first_invalid(std::array{Task{1, 1}, Task{1, 0}, Task{}}) == 1);

constexpr auto levels(const std::array<Task, 4>& tasks) {
  return std::array{tasks[0].level, tasks[1].level, tasks[2].level, tasks[3].level};
}
static_assert(levels(in_order(mixed)) == std::array{0U, 1U, 2U, 3U});
static_assert(levels(rate_monotonic(mixed)) == std::array{2U, 0U, 3U, 1U});      // of equal ones, the first
static_assert(levels(deadline_monotonic(mixed)) == std::array{0U, 1U, 2U, 3U});  // 9, 20, 30, 40

TEST_CASE("tasks without levels are peers") {
  CHECK(mixed[0].level == mixed[3].level);
}

}  // namespace analysis_task_set_test
