#include "ocm/analysis/task_response.hpp"

#include <array>
#include <limits>
#include <numeric>
#include <vector>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"

namespace analysis_task_response_test {

using namespace ocm::analysis;

constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();

template <std::size_t N>
constexpr std::array<std::int64_t, N> responses(const std::array<Task, N>& tasks,
                                                const Processor& processor = {}) {
  std::array<std::int64_t, N> result{};
  const auto all = response_times(tasks, processor);
  for (std::size_t i = 0; i < N; ++i) result[i] = all[i].response;
  return result;
}
template <std::size_t N>
using Times = std::array<std::int64_t, N>;

// [Burns, Wellings 2006, chapter 11, process sets A, B, C; Audsley et al. 1993]
constexpr auto set_a = rate_monotonic(std::array{Task{12, 50}, Task{10, 40}, Task{10, 30}});
static_assert(responses(set_a) == Times<3>{52, 20, 10});
static_assert(first_miss(set_a) == 0 && verdict(set_a, 0) == Reason::misses_deadline);
// As many as both have room for.
template <std::size_t Room>
constexpr std::array<Explained, Room> in_room_of() {
  std::array<Explained, Room> results{};
  response_times(std::span<const Task>{set_a}, std::span<Explained>{results});
  return results;
}
static_assert(in_room_of<1>()[0] == response_times(set_a)[0]);
static_assert(in_room_of<set_a.size() + 1>()[set_a.size()] == Explained{});
static_assert(response_times(set_a)[0].slack() == -2);
constexpr auto set_b = rate_monotonic(std::array{Task{32, 80}, Task{5, 40}, Task{4, 16}});
static_assert(responses(set_b) == Times<3>{58, 9, 4} && all_schedulable(set_b));
constexpr auto set_c = rate_monotonic(std::array{Task{40, 80}, Task{10, 40}, Task{5, 20}});
static_assert(responses(set_c) == Times<3>{80, 15, 5} && all_schedulable(set_c));  // at U = 1
static_assert(utilisation(set_c).versus_one() == Comparison::equal);
static_assert(responses(in_order(std::array{Task{3, 7}, Task{3, 12}, Task{5, 20}})) == Times<3>{3, 6, 20});
static_assert(responses(deadline_monotonic(std::array{Task{3, 20, 5}, Task{3, 15, 7}, Task{4, 10, 10},
                                                      Task{3, 20, 20}})) == Times<4>{3, 6, 10, 20});

// Of its ten the first waits six for what less urgent ones hold: it takes four from those below, and all ten
// from its own level.
constexpr Task waiting{.cost = 10, .period = 20, .waits = 6};
constexpr auto beside(Task other, const Processor& processor = {}) {
  return responses(std::array{waiting, other}, processor);
}
static_assert(beside({.cost = 5, .period = 100, .level = 1}) == Times<2>{10, 9});
static_assert(beside({.cost = 5, .period = 100}) == Times<2>{15, 15});
static_assert(beside({.cost = 17, .period = 100, .level = 1}) == Times<2>{10, 25});
static_assert(beside({.cost = 5, .period = 100, .level = 1}, {.interrupt = 1}) == Times<2>{12, 11});
// Its work may come six later than its release, and that of the next job at once: 0 to 4, and 14 to 18.
static_assert(beside({.cost = 11, .period = 100, .level = 1}) == Times<2>{10, 19});
// On a slower processor by nine of 15.
static_assert(beside({.cost = 5, .period = 100, .level = 1}, {.scale = 1'500'000}) == Times<2>{15, 20});
// With two switches a job: 6 of 12 are taken, up to six late.
static_assert(beside({.cost = 5, .period = 100, .level = 1}, {.context_switch = 1}) == Times<2>{12, 13});
// One that comes six late, and takes nine of its ten then, is done by 16: what it takes may come seven late.
constexpr Task late_waiting{.cost = 10, .period = 20, .deadline = 16, .jitter = 6, .waits = 1};
static_assert(responses(std::array{late_waiting, Task{.cost = 5, .period = 100, .level = 1}}) ==
              Times<2>{16, 23});
// One that misses its deadline is late by that at most, or nothing is promised: 8 - 4. Its jitter counts all
// the same.
constexpr Task missing{.cost = 10, .period = 20, .deadline = 8, .waits = 6};
static_assert(responses(std::array{missing, Task{.cost = 11, .period = 100, .level = 1}})[1] == 15);
constexpr Task missing_late{.cost = 10, .period = 20, .deadline = 8, .jitter = 6, .waits = 1};
static_assert(responses(std::array{missing_late, Task{.cost = 6, .period = 100, .level = 1}})[1] == 24);
static_assert(!Task{.cost = 10, .period = 20, .waits = 10}.valid());
static_assert(!Task{.cost = 10, .period = 20, .waits = -1}.valid());

// Deadlines beyond the period: the fifth instance is the worst, the first is not. [Lehoczky 1990]
constexpr auto long_busy = in_order(std::array{Task{26, 70}, Task{62, 100, 118}});
static_assert([] {
  Times<8> instances{};
  const Explained second = response_time(long_busy, 1, {}, {}, instances);
  return second.response == 118 && second.instance == 4 && second.instances == 7 && second.ok() &&
         instances == Times<8>{114, 102, 116, 104, 118, 106, 94, 0};
}());
static_assert([] {
  Times<2> instances{};  // room for fewer
  return response_time(long_busy, 1, {}, {}, instances).response == 118 && instances == Times<2>{114, 102};
}());  // less room

// Jitter: of those above it delays more often, its own counts from the release as planned.
static_assert(responses(in_order(std::array{Task{3, 10, 10, 0}, Task{5, 20}})) == Times<2>{3, 8});
static_assert(responses(in_order(std::array{Task{3, 10, 10, 3}, Task{5, 20}})) == Times<2>{6, 11});
static_assert(responses(in_order(std::array{Task{3, 10, 10, 2}, Task{5, 20, 20, 6}})) == Times<2>{5, 14});
// More jitter than a period: releases pile up.
static_assert(responses(in_order(std::array{Task{2, 10, 40, 25}, Task{1, 100}})) == Times<2>{27, 9});

// Blocking is paid once in a busy period.
static_assert(responses(in_order(std::array{Task{3, 10, 10, 0, 4}, Task{5, 20, 20, 0, 2}})) ==
              Times<2>{7, 10});
static_assert(response_times(in_order(std::array{Task{26, 70}, Task{62, 100, 200, 0, 10}}))[1].response ==
              138);

// Peers delay each other; a set without levels is one of peers.
static_assert(responses(std::array{Task{3, 10}, Task{4, 20}}) == Times<2>{7, 7});

// The processor's own: each job two switches, each release an interrupt, a tick ahead of all.
static_assert(responses(in_order(std::array{Task{3, 20}, Task{5, 40}}), {.context_switch = 1}) ==
              Times<2>{5, 12});
static_assert(responses(in_order(std::array{Task{3, 20}, Task{5, 40}}), {.interrupt = 1}) == Times<2>{5, 10});
static_assert(responses(in_order(std::array{Task{3, 20}, Task{5, 40}}), {.lock = 2}) == Times<2>{5, 10});
static_assert(responses(in_order(std::array{Task{3, 20}, Task{5, 40}}), {.tick_cost = 1, .tick_period = 4}) ==
              Times<2>{4, 11});
static_assert(responses(in_order(std::array{Task{3, 20}, Task{5, 40}}),
                        {.tick_period = 4, .released_by_tick = true}) == Times<2>{7, 12});
static_assert(responses(in_order(std::array{Task{3, 20}, Task{5, 40}}), {.scale = 1'500'000}) ==
              Times<2>{5, 13});
static_assert(responses(in_order(std::array{Task{3, 20, 20, 0, 2}, Task{5, 40}}), {.scale = 2'000'000})[0] ==
              10);

// The explanation.
static_assert([] {
  Times<3> shares{};
  const auto tasks = in_order(std::array{Task{3, 7}, Task{3, 12}, Task{5, 20, 30, 4, 1, 0, 2, 9}});
  const Explained low = response_time(tasks, 2, {}, {}, {}, shares);
  return low.largest == 0 && low.largest_share == shares[0] && low.blocking == 1 && low.blocked_by == 9 &&
         shares[2] == 0 && low.interference == shares[0] + shares[1] && low.deadline == 30 &&
         low.response == 4 + 1 + 5 + low.interference;  // its worst instance is the first
}());

// Of two that delay it as much, the one above.
static_assert(response_times(in_order(std::array{Task{2, 10}, Task{2, 10}, Task{1, 100}}))[2].largest == 0);

// --- what cannot be bounded has a reason ---

constexpr Explained overloaded =
    response_times(in_order(std::array{Task{5, 10}, Task{11, 20}, Task{1, 1000}}))[1];
static_assert(overloaded.reason == Reason::overloaded && !overloaded.bounded() && overloaded.largest == 1);
// Of two that ask for the same, the one above.
static_assert(response_times(in_order(std::array{Task{6, 10}, Task{6, 10}}))[1].largest == 0);
// Those above the overload do not notice.
static_assert(response_times(in_order(std::array{Task{5, 10}, Task{11, 20}}))[0].ok());
static_assert(response_times(in_order(std::array{Task{11, 10}}))[0].reason == Reason::overloaded);
// At exactly 1 a busy period ends, unless something blocks or comes late.
static_assert(response_times(in_order(std::array{Task{5, 10}, Task{5, 10, 10, 0, 0}}))[1].response == 10);
static_assert(response_times(in_order(std::array{Task{5, 10}, Task{5, 10, 20, 0, 1}}))[1].reason ==
              Reason::overloaded);
static_assert(response_times(in_order(std::array{Task{5, 10}, Task{5, 10, 20, 1, 0}}))[1].reason ==
              Reason::overloaded);
static_assert(response_times(in_order(std::array{Task{5, 10, 20, 1}, Task{5, 10}}))[1].reason ==
              Reason::overloaded);
static_assert(response_times(in_order(std::array{Task{1, 3}, Task{1, 3}, Task{1, 3}}))[2].response == 3);
// Overhead counts.
static_assert(response_times(in_order(std::array{Task{4, 10}, Task{4, 10}}), {.context_switch = 1})[1]
                  .reason == Reason::overloaded);
static_assert(
    response_times(in_order(std::array{Task{4, 10}}), {.tick_cost = 6, .tick_period = 10})[0].response == 10);
static_assert(response_times(in_order(std::array{Task{4, 10}}), {.tick_cost = 7, .tick_period = 10})[0]
                  .reason == Reason::overloaded);

static_assert(response_time(set_a, 3).reason == Reason::bad_input);
static_assert(response_time({}, 0).reason == Reason::bad_input && all_schedulable({}));
static_assert(response_time(set_a, 0, {.context_switch = -1}).reason == Reason::bad_input);
template <class Change>
constexpr bool bad(Change change) {
  auto tasks = set_a;
  change(tasks[1]);
  const Explained result = response_time(tasks, 2);
  return result.reason == Reason::bad_input && result.largest == 1 && !result.bounded();
}
static_assert(bad([](Task& task) { task.period = 0; }) && bad([](Task& task) { task.period = -40; }));
static_assert(bad([](Task& task) { task.cost = 0; }) && bad([](Task& task) { task.cost = -1; }));
static_assert(bad([](Task& task) { task.deadline = 0; }) && bad([](Task& task) { task.deadline = -1; }));
static_assert(bad([](Task& task) { task.jitter = -1; }) && bad([](Task& task) { task.blocking = -1; }));
static_assert(bad([](Task& task) { task.period = std::numeric_limits<std::int64_t>::min(); }));

// Huge and tiny.
static_assert(responses(in_order(std::array{Task{1, 2}, Task{1LL << 60, most}})) == Times<2>{1, 1LL << 61});
// 1/2 + 2^62 / (2^63 - 1) is above 1 by 2^-64, too little to see; so it is tried, and leaves 63 bits.
static_assert(response_times(in_order(std::array{Task{1, 2}, Task{1LL << 62, most}}))[1].reason ==
              Reason::too_long);
static_assert(response_times(in_order(std::array{Task{1, 3}, Task{1LL << 62, most}}))[1].response ==
              (1LL << 62) + (1LL << 61));
static_assert(response_times(in_order(std::array{Task{1, 10}, Task{1, most, most, most}}))[1].reason ==
              Reason::too_long);  // J + w has no 63 bits
static_assert(response_times(in_order(std::array{Task{1, 10, most, most - 5}, Task{1, 10}}))[1].reason ==
              Reason::too_long);
static_assert(response_times(in_order(std::array{Task{most, most}}))[0].response == most);
static_assert(response_times(in_order(std::array{Task{most, most}}), {.context_switch = 1})[0].reason !=
              Reason::schedulable);
static_assert(response_times(in_order(std::array{Task{most / 2, most}}), {.scale = most})[0].reason !=
              Reason::schedulable);

// Costs of more than 33 bits: twice the processor is too much.
static_assert(
    response_time(in_order(std::array{Task{1LL << 33, (1LL << 33) + 1}, Task{1LL << 33, (1LL << 33) + 1}}), 1)
        .reason == Reason::overloaded);

// A task that has nothing to wait for is not blocked, whatever the set says.
static_assert(response_time(in_order(std::array{Task{.cost = 1, .period = 9, .blocked_by = 9}}), 0)
                  .blocked_by == no_index);

TEST_CASE("an analysis that does not converge ends with a reason") {
  // U is below 1 by 10^-12, and the busy period of some 10^12 instances.
  const auto tasks =
      in_order(std::array{Task{999'999'999'999, 1'000'000'000'000, most / 2, 0, 1'000'000'000'000}});
  const Explained result = response_time(tasks, 0);
  CHECK(result.reason == Reason::too_long);
  CHECK_FALSE(result.bounded());
  CHECK(response_time(tasks, 0, {}, {.terms = 0}).reason == Reason::too_long);
  CHECK(response_time(set_b, 0, {}, {.terms = 6}).ok());  // two steps of three terms
  CHECK(response_time(set_b, 0, {}, {.terms = 5}).reason == Reason::too_long);
}

TEST_CASE("with what interrupts take of all time, the first step is nearly there") {
  // 900 ticks of its own in 1000, of which a timer takes a tenth.
  constexpr std::array<Task, 1> tasks{{{900, 2000}}};
  constexpr Processor processor{.tick_cost = 1, .tick_period = 10};
  CHECK(response_time(tasks, 0, processor).response == 1000);
  CHECK(response_time(tasks, 0, processor, {.terms = 2}).ok());
}

TEST_CASE("a step towards the bound is skipped, never the bound") {
  // Against the iteration as in the paper, from C on, with all instances up to the end of the busy period.
  ocm::test::Random random{4};
  int bounded = 0;
  for (int i = 0; i < 20'000; ++i) {
    std::array<Task, 4> tasks;
    for (Task& task : tasks) {
      task.period = random.within(4, 400);
      task.cost = random.within(1, static_cast<int>(task.period) / 3);
      task.deadline = random.within(1, 3 * static_cast<int>(task.period));
      task.jitter = random.within(0, 1) * random.within(0, 2 * static_cast<int>(task.period));
      task.blocking = random.within(0, 1) * random.within(0, 50);
      task.level = random.below(3);
    }
    for (std::size_t index = 0; index < 4; ++index) {
      const Task& task = tasks[index];
      double load = 0;
      for (const Task& other : tasks)
        if (other.level <= task.level)
          load += static_cast<double>(other.cost) / static_cast<double>(other.period);
      const Explained result = response_time(tasks, index);
      if (load > 0.99) continue;
      ++bounded;
      const auto demand = [&](std::int64_t window, bool with_own) {
        std::int64_t sum = task.blocking;
        for (std::size_t k = 0; k < 4; ++k)
          if (tasks[k].level <= task.level && (k != index || with_own))
            sum += (window + tasks[k].jitter + tasks[k].period - 1) / tasks[k].period * tasks[k].cost;
        return sum;
      };
      std::int64_t busy = task.cost;
      while (demand(busy, true) != busy) busy = demand(busy, true);
      const std::int64_t count = (busy + task.jitter + task.period - 1) / task.period;
      std::int64_t worst = 0;
      for (std::int64_t q = 0; q < count; ++q) {
        std::int64_t window = (q + 1) * task.cost;
        while (demand(window, false) + (q + 1) * task.cost != window)
          window = demand(window, false) + (q + 1) * task.cost;
        worst = std::max(worst, window + task.jitter - q * task.period);
      }
      REQUIRE(result.response == worst);
      REQUIRE(static_cast<std::int64_t>(result.instances) == count);
      REQUIRE(result.ok() == (worst <= task.deadline));
      REQUIRE(verdict(tasks, index) == result.reason);
      const auto q = static_cast<std::int64_t>(result.instance);
      REQUIRE(result.response ==
              task.jitter + result.blocking + (q + 1) * task.cost + result.interference - q * task.period);
    }
  }
  CHECK(bounded > 40'000);
}

TEST_CASE("two thousand tasks") {
  std::vector<Task> tasks;
  for (int i = 0; i < 2048; ++i)
    tasks.push_back({1, 2200 + i, implicit_deadline, 0, 0, static_cast<std::uint32_t>(i)});
  CHECK(utilisation(tasks).versus_one() == Comparison::below);
  for (const std::size_t i : {std::size_t{0}, std::size_t{1000}, std::size_t{2047}}) {
    const Explained result = response_time(tasks, i);
    CHECK(result.ok());
    CHECK(result.response == static_cast<std::int64_t>(i) + 1);
  }
  for (Task& task : tasks) task.cost = 3;
  CHECK(response_time(tasks, 2047).reason == Reason::overloaded);
}

}  // namespace analysis_task_response_test
