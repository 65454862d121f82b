// Two tasks of 30 of 50 ticks ask for more than there is: the less urgent one never ends.
// expect g++: misses_its_deadline<Tower, 9223372036854775807, 50>
// expect clang++: misses_its_deadline<Tower, 9223372036854775807, 50>
#include "ocm/analysis/task_list.hpp"

using namespace ocm::analysis;

#ifdef OCM_MUST_FAIL
inline constexpr std::int64_t cost = 30;
#else
inline constexpr std::int64_t cost = 20;
#endif

struct Estimator {
  static constexpr Task task{.cost = 30, .period = 50, .level = 0};
};
struct Tower {
  static constexpr Task task{.cost = cost, .period = 50, .level = 1};
};

static_assert(schedulable<TaskList<Estimator, Tower>>);
