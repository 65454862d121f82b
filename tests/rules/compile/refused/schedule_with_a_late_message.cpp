// Two messages of 270 ticks, the first of which must be over 300 ticks after its release, but waits for 270.
// expect g++: misses_its_deadline<Pose, 540, 300>
// expect clang++: misses_its_deadline<Pose, 540, 300>
#include "ocm/analysis/schedulable.hpp"

using namespace ocm::analysis;

#ifdef OCM_MUST_FAIL
inline constexpr std::int64_t deadline = 300;
#else
inline constexpr std::int64_t deadline = 540;
#endif

struct Pose {
  static constexpr Message message{.cost = 270, .period = 1'000, .deadline = deadline, .key = 1};
};
struct Battery {
  static constexpr Message message{.cost = 270, .period = 1'000, .key = 2};
};

static_assert(schedulable<Traffic<1, Pose, Battery>>);
