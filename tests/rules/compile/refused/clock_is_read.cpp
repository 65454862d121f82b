// Time is handed in, never read: the library's clock cannot tell it.
// expect g++: 'now' is not a member of 'ocm::base::Clock'
// expect clang++: no member named 'now' in 'ocm::base::Clock'
#include "ocm/base/time.hpp"

ocm::base::Time later(ocm::base::Time now) {
#ifdef OCM_MUST_FAIL
  now = ocm::base::Clock::now();
#endif
  return now + std::chrono::seconds{1};
}
