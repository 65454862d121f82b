// 1 of what? A duration takes another duration, never a bare number.
// expect g++: no match for 'operator+'
// expect clang++: invalid operands to binary expression
#include "ocm/base/time.hpp"

constexpr ocm::base::Duration longer(ocm::base::Duration period) {
#ifdef OCM_MUST_FAIL
  return period + 1;
#else
  return period + std::chrono::milliseconds{1};
#endif
}
static_assert(longer(std::chrono::milliseconds{1}).count() == 2'000'000);
