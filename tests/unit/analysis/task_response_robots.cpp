// The task sets of two robots, from a thesis of 2016 on mapping robots with FreeRTOS (tables 9.2 and 9.3,
// appendix J): the right response times, and the published ones by the thesis's own rule. spec/conflicts.md
// lists its errors.
#include <array>
#include <string_view>

#include <catch2/catch.hpp>

#include "ocm/analysis/task_response.hpp"
#include "ocm/analysis/utilisation.hpp"

namespace analysis_task_response_robots_test {

using namespace ocm::analysis;

// Nanoseconds; encoders left and right, UART, estimator, movement, communication, pose, tower.
constexpr auto avr = in_order(std::array<Task, 8>{{{1'700, 15'000'000},
                                                   {1'640, 15'000'000},
                                                   {2'960, 103'000'000},
                                                   {1'700'000, 30'000'000},
                                                   {43'000, 20'000'000},
                                                   {140'000, 103'000'000},
                                                   {255'000, 30'000'000},
                                                   {7'300'000, 200'000'000}}});
constexpr auto arduino = in_order(std::array<Task, 8>{{{610, 800'000},
                                                       {610, 800'000},
                                                       {3'400, 103'000'000},
                                                       {1'660'000, 30'000'000},
                                                       {41'000, 20'000'000},
                                                       {130'000, 103'000'000},
                                                       {187'000, 30'000'000},
                                                       {5'880'000, 200'000'000}}});

constexpr std::array<std::int64_t, 8> responses(const std::array<Task, 8>& tasks) {
  std::array<std::int64_t, 8> result{};
  const auto all = response_times(tasks);
  for (std::size_t i = 0; i < 8; ++i) result[i] = all[i].response;
  return result;
}
static_assert(responses(avr) == std::array<std::int64_t, 8>{1'700, 3'340, 6'300, 1'706'300, 1'749'300,
                                                            1'889'300, 2'144'300, 9'444'300});
static_assert(responses(arduino) == std::array<std::int64_t, 8>{610, 1'220, 4'620, 1'667'060, 1'708'060,
                                                                1'838'060, 2'025'060, 7'913'600});
static_assert(all_schedulable(avr) && all_schedulable(arduino));

// U .1054 and .0958, and no test of it applies: the tower's robot is not rate monotonic.
static_assert(utilisation(avr).parts_per_million() == 105'428);
static_assert(utilisation(arduino).parts_per_million() == 95'837);
static_assert(liu_layland(avr) == Proof::not_rate_monotonic &&
              hyperbolic(arduino) == Proof::not_rate_monotonic);
static_assert(liu_layland(rate_monotonic(avr)) == Proof::proven);
static_assert(liu_layland(rate_monotonic(arduino)) == Proof::proven);

/// The thesis's rule: whole periods that have passed, and at least one.
constexpr std::int64_t thesis(const std::array<Task, 8>& tasks, std::size_t i) {
  std::int64_t window = tasks[i].cost;
  for (;;) {
    std::int64_t next = tasks[i].cost;
    for (std::size_t k = 0; k < i; ++k) {
      const std::int64_t periods = window / tasks[k].period;
      next += (periods < 1 ? 1 : periods) * tasks[k].cost;
    }
    if (next == window) return window;
    window = next;
  }
}
constexpr std::array<std::int64_t, 8> published(const std::array<Task, 8>& tasks) {  // to 0.1 us, as printed
  std::array<std::int64_t, 8> result{};
  for (std::size_t i = 0; i < 8; ++i) result[i] = (thesis(tasks, i) + 50) / 100;
  return result;
}
/// With the Arduino's encoders on the AVR, and the right encoder as slow as the left one.
constexpr auto avr_as_calculated = [] {
  auto tasks = avr;
  tasks[0].period = tasks[1].period = 800'000;
  tasks[1].cost = 1'700;
  return tasks;
}();
static_assert(published(avr_as_calculated) ==
              std::array<std::int64_t, 8>{17, 34, 64, 17'098, 17'528, 18'928, 21'478, 94'784});
static_assert(published(arduino) ==
              std::array<std::int64_t, 8>{6, 12, 46, 16'658, 17'068, 18'368, 20'238, 79'124});
// Its rule is optimistic: less than the truth of the Arduino, whose tower can be delayed by ten ticks, not
// nine.
static_assert(thesis(arduino, 7) < responses(arduino)[7]);

/// The published U, .1044 and .0948, come out if the movement task had a period of 40 ms.
constexpr auto slow_movement = [](std::array<Task, 8> tasks) {
  tasks[4].period = 40'000'000;
  return utilisation(tasks).parts_per_million();
};
static_assert((slow_movement(avr) + 50) / 100 == 1'044 && (slow_movement(arduino) + 50) / 100 == 948);
static_assert(liu_layland_bound(8) / 100 == 7'240);  // .72406, which is the thesis's .7241

TEST_CASE("who delays the tower most") {
  std::array<std::int64_t, 8> shares{};
  const Explained tower = response_time(avr, 7, {}, {}, {}, shares);
  CHECK(tower.largest == 3);
  CHECK(tower.largest_share == 1'700'000);
  CHECK(tower.interference == 2'144'300);
  CHECK(shares == std::array<std::int64_t, 8>{1'700, 1'640, 2'960, 1'700'000, 43'000, 140'000, 255'000, 0});
  CHECK(tower.slack() == 190'555'700);
}

}  // namespace analysis_task_response_robots_test
