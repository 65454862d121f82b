// A dispatcher on a port whose lock is a pair of functions would forget the second one.
// expect g++: constraint
// expect clang++: constraints not satisfied
#include "ocm/scheduling/dispatcher.hpp"

using namespace ocm;

struct Guard {
  ~Guard() {}
};
struct Rtos {
  base::Time now();
  void arm(base::Time);
  void pend(scheduling::Level);
#ifdef OCM_MUST_FAIL
  void lock();
  void unlock();
#else
  Guard lock();
#endif
};

void set_up(Rtos& rtos) {
  scheduling::Dispatcher<1, Rtos> dispatcher{rtos};
  dispatcher.stop(0);
}
