#include "ocm/analysis/blocking.hpp"

#include <array>
#include <limits>
#include <set>
#include <string_view>

#include <catch2/catch.hpp>

#include "ocm/analysis/task_response.hpp"

namespace analysis_blocking_test {

using namespace ocm::analysis;

constexpr auto four = in_order(std::array{Task{50, 1000}, Task{50, 2000}, Task{50, 3000}, Task{50, 4000}});

template <std::size_t S>
constexpr std::array<std::int64_t, 4> blocked(const std::array<Section, S>& sections, Protocol protocol) {
  auto tasks = four;
  std::array<std::uint32_t, S> scratch{};
  if (set_blocking(tasks, sections, protocol, scratch) != Table::good) return {-1};
  return {tasks[0].blocking, tasks[1].blocking, tasks[2].blocking, tasks[3].blocking};
}
using Times = std::array<std::int64_t, 4>;
constexpr auto inherit = Protocol::inheritance;
constexpr auto ceil = Protocol::ceiling;

// Two resources, one shared by 0 and 3, one by 1 and 2; 1 is pushed through by 3, 2 by 3 only.
constexpr std::array two{Section{0, 7, 5}, Section{3, 7, 9}, Section{1, 8, 4}, Section{2, 8, 6}};
static_assert(blocked(two, inherit) == Times{9, 15, 9, 0});
static_assert(blocked(two, ceil) == Times{9, 9, 9, 0});

// One task with two sections, two tasks with one resource: each counts once.
constexpr std::array one_task{Section{0, 1, 1}, Section{0, 2, 1}, Section{3, 1, 8}, Section{3, 2, 9}};
static_assert(blocked(one_task, inherit) == Times{9, 9, 9, 0});
constexpr std::array one_resource{Section{0, 1, 1}, Section{2, 1, 8}, Section{3, 1, 9}};
static_assert(blocked(one_resource, inherit) == Times{9, 9, 9, 0});
constexpr std::array both{Section{0, 1, 1}, Section{0, 2, 1}, Section{2, 1, 8}, Section{3, 2, 9}};
static_assert(blocked(both, inherit) == Times{17, 17, 9, 0});
static_assert(blocked(both, ceil) == Times{9, 9, 9, 0});

// Of equal sections the first is named, and each group has one: here two resources, and one task.
static_assert([] {
  constexpr std::array equal{Section{0, 1, 1}, Section{0, 2, 1}, Section{3, 1, 8}, Section{3, 2, 8}};
  auto tasks = four;
  std::array<std::uint32_t, 4> scratch{};
  if (set_blocking(tasks, equal, inherit, scratch) != Table::good) return false;
  const Blocking first = blocking_of(tasks, equal, scratch, inherit, 0);
  return first.time == 8 && first.sections == 1 && first.by == 3 && first.section == 2;
}());
// A section that takes no time holds up no task.
static_assert([] {
  constexpr std::array empty{Section{0, 1, 1}, Section{3, 1, 0}};
  auto tasks = four;
  std::array<std::uint32_t, 2> scratch{};
  return set_blocking(tasks, empty, ceil, scratch) == Table::good && tasks[0].blocking == 0 &&
         tasks[0].blocked_by == no_index;
}());

// A resource of less urgent ones alone holds up no task above them; peers are no less urgent.
static_assert(blocked(std::array{Section{2, 1, 8}, Section{3, 1, 9}}, inherit) == Times{0, 0, 9, 0});
constexpr auto peers = with_blocking(std::array{Task{9, 99}, Task{9, 99}},
                                     std::array{Section{0, 1, 5}, Section{1, 1, 6}}, inherit);
static_assert(peers[0].blocking == 0 && peers[1].blocking == 0);

// The lesser of the two sums, where 63 bits do not hold the other one; where they hold neither, no bound.
constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();
constexpr auto of_one_task = with_blocking(
    in_order(std::array{Task{1, most}, Task{most, most}}),
    std::array{Section{0, 1, 1}, Section{0, 2, 1}, Section{1, 1, most - 9}, Section{1, 2, most - 9}},
    inherit);
static_assert(of_one_task[0].blocking == most - 9);
constexpr auto of_two_tasks = with_blocking(
    in_order(std::array{Task{1, most}, Task{most, most}, Task{most, most}}),
    std::array{Section{0, 1, 1}, Section{0, 2, 1}, Section{1, 1, most - 9}, Section{2, 2, most - 9}},
    inherit);
static_assert(of_two_tasks[0].blocking == unbounded);

// Nested: 3 claims B inside A; A is used by 0. Task 2 has B, so it can hold up 0 through 3, which waits for
// B.
constexpr std::array nested{Section{0, 1, 5}, Section{3, 1, 20}, Section{3, 2, 10, 1}, Section{2, 2, 30}};
static_assert(blocked(nested, inherit) == Times{50, 50, 20, 0});
static_assert(blocked(nested, ceil) == Times{20, 20, 20, 0});
// A row that holds up no task may have one inside that does, for its own length.
constexpr std::array inner{Section{0, 2, 5}, Section{3, 1, 20}, Section{3, 2, 10, 1}};
static_assert(blocked(inner, inherit) == Times{10, 10, 10, 0} &&
              blocked(inner, ceil) == Times{10, 10, 10, 0});

// Who, and how often.
static_assert([] {
  auto tasks = four;
  std::array<std::uint32_t, 4> scratch{};
  if (set_blocking(tasks, both, inherit, scratch) != Table::good) return false;
  const Blocking first = blocking_of(tasks, both, scratch, inherit, 0);
  return first.time == 17 && first.sections == 2 && first.by == 3 && first.section == 3 &&
         tasks[0].blocked_by == 3 && tasks[3].blocked_by == no_index && tasks[0].switches == 6 &&
         tasks[1].switches == 2 && blocking_of(tasks, both, scratch, inherit, 3).sections == 0;
}());
constexpr auto set = with_blocking(four, both, ceil);
static_assert(set[0].switches == 2 && set[0].blocked_by == 3);  // under a ceiling no task waits in the middle
static_assert(response_time(set, 0).response == 59 && response_time(set, 0).blocked_by == 3);

// What is wrong with a table.
template <std::size_t S>
constexpr Table refused(const std::array<Section, S>& sections, Protocol protocol = inherit) {
  auto tasks = four;
  std::array<std::uint32_t, S> scratch{};
  const Table table = set_blocking(tasks, sections, protocol, scratch);
  return tasks == four ? table : Table::good;
}
static_assert(refused(std::array{Section{4, 1, 1}}) == Table::no_such_task);
static_assert(refused(std::array{Section{0, 1, -1}}) == Table::bad_length);
static_assert(refused(std::array{Section{0, 1, 51}}) == Table::bad_length);
static_assert(refused(std::array{Section{0, 1, 5}, Section{0, 2, 6, 0}}) == Table::bad_length);
static_assert(refused(std::array{Section{0, 1, 5}, Section{0, 1, 4, 0}}) == Table::bad_nesting);
static_assert(refused(std::array{Section{0, 1, 5, 0}}) == Table::bad_nesting);
static_assert(refused(std::array{Section{0, 1, 5}, Section{1, 2, 4, 0}}) == Table::bad_nesting);
// Inside a later row, one that is not there, or two levels deep in the same resource.
static_assert(refused(std::array{Section{0, 1, 4, 1}, Section{0, 2, 5}}) == Table::bad_nesting);
static_assert(refused(std::array{Section{0, 1, 5}, Section{0, 2, 4, 2}}) == Table::bad_nesting);
static_assert(refused(std::array{Section{0, 1, 5}, Section{0, 2, 4, 0}, Section{0, 1, 3, 1}}) ==
              Table::bad_nesting);
// As long as its job, and as what is around it, a section may be.
static_assert(blocked(std::array{Section{0, 1, 50}, Section{0, 2, 50, 0}}, inherit) == Times{0, 0, 0, 0});
constexpr std::array crossed{Section{0, 1, 5}, Section{0, 2, 4, 0}, Section{1, 2, 5}, Section{1, 1, 4, 2}};
static_assert(refused(crossed) == Table::deadlock);
static_assert(blocked(crossed, ceil) == Times{5, 0, 0, 0});  // a ceiling prevents it
static_assert(refused(std::array{Section{0, 1, 5}, Section{0, 2, 4, 0}, Section{1, 2, 5}, Section{1, 3, 4, 2},
                                 Section{2, 3, 5}, Section{2, 1, 4, 4}}) == Table::deadlock);
static_assert([] {
  auto tasks = four;
  return set_blocking(tasks, two, inherit, {}) == Table::no_room && tasks == four;
}());

TEST_CASE("no sections, no blocking") {
  auto tasks = four;
  tasks[1].blocking = 5;
  tasks[1].switches = 8;
  CHECK(set_blocking(tasks, {}, inherit, {}) == Table::good);
  CHECK(tasks == four);
}

TEST_CASE("every mistake in a table has words of its own") {
  std::set<std::string_view> words;
  for (int i = 0; i <= static_cast<int>(Table::no_room); ++i)
    CHECK(words.insert(describe(static_cast<Table>(i))).second);
  CHECK(words.count("unknown") == 0);
}

}  // namespace analysis_blocking_test
