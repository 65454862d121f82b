#include "ocm/analysis/task_sets.hpp"

#include <array>
#include <cstdint>

#include <catch2/catch.hpp>

namespace analysis_task_sets_test {

using namespace ocm::analysis;

template <class Facts>
constexpr auto responses() {
  std::array<std::int64_t, Facts::Tasks::size> result{};
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = Facts::Tasks::results[i].response;
  return result;
}

// The two robots of the second thesis, in nanoseconds: what its tables should say. Found by three independent
// tools; spec/conflicts.md has what it does say.
static_assert(responses<task_sets::thesis_avr::Facts>() ==
              std::array<std::int64_t, 8>{1'700, 3'340, 6'300, 1'706'300, 1'749'300, 1'889'300, 2'144'300,
                                          9'444'300});
static_assert(responses<task_sets::thesis_arduino::Facts>() ==
              std::array<std::int64_t, 8>{610, 1'220, 4'620, 1'667'060, 1'708'060, 1'838'060, 2'025'060,
                                          7'913'600});
static_assert(schedulable<task_sets::thesis_avr::Facts::Tasks>);
static_assert(schedulable<task_sets::thesis_arduino::Facts::Tasks>);
static_assert(schedulable<task_sets::di_wheel_drive::Facts::Tasks>);
static_assert(schedulable<task_sets::power_management::Facts::Tasks>);
static_assert(schedulable<task_sets::light_ring::Facts::Tasks>);

TEST_CASE("The robots' utilisation is that of their tables") {
  CHECK(utilisation(task_sets::thesis_avr::Facts::Tasks::tasks).parts_per_million() / 100 == 1'054);
  CHECK(utilisation(task_sets::thesis_arduino::Facts::Tasks::tasks).parts_per_million() / 100 == 958);
}

}  // namespace analysis_task_sets_test
