// A raw number that its member does not hold.
// expect g++: narrowing conversion of '40000'
// expect clang++: constant expression evaluates to 40000 which cannot be narrowed
#include "ocm/topics/amiro.hpp"

#ifdef OCM_MUST_FAIL
constexpr amiro::Gyroscope gyroscope{40'000, 0, 0};
#else
constexpr amiro::Gyroscope gyroscope{4'000, 0, 0};
#endif
static_assert(gyroscope.x_deg_per_s() == 70.0);
