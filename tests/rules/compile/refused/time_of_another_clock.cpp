// A board's time is not the wall's: the caller says how the one becomes the other.
// expect g++: cannot convert
// expect clang++: no viable conversion from
#include <chrono>

#include "ocm/controller/watchdog.hpp"

void feed(ocm::controller::Watchdog& watchdog, std::chrono::system_clock::time_point wall) {
#ifdef OCM_MUST_FAIL
  watchdog.feed(wall);
#else
  watchdog.feed(ocm::base::Time{wall.time_since_epoch()});
#endif
}
