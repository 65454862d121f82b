// The unit is in the accessor's name: a gyroscope that speaks degrees has no radians.
// expect g++: has no member named 'x_rad_per_s'
// expect clang++: no member named 'x_rad_per_s'
#include "ocm/topics/amiro.hpp"

constexpr amiro::Gyroscope gyroscope{62, 30, -4};
#ifdef OCM_MUST_FAIL
static_assert(gyroscope.x_rad_per_s() > 0);
#else
static_assert(gyroscope.x_deg_per_s() > 0);
#endif
