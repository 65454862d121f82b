// A frame that could not be made is not a frame that was sent: the result is looked at.
// expect g++: ignoring returned value of type
// expect clang++: ignoring return value of
#include "ocm/base/fixed_vector.hpp"
#include "ocm/can/bus.hpp"

bool keep(ocm::base::FixedVector<int, 2>& numbers) {
#ifdef OCM_MUST_FAIL
  numbers.push_back(1);
#endif
  return numbers.push_back(2).ok();
}
