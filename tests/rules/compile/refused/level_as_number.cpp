// A level is urgent, high, medium or low: which end of 0..255 an RTOS calls urgent does not matter here.
// expect g++: cannot convert
// expect clang++: cannot initialize a parameter
#include "ocm/scheduling/cooperative.hpp"
#include "ocm/scheduling/dispatcher.hpp"

using namespace ocm;

void set_up(scheduling::Dispatcher<1, scheduling::Cooperative>& dispatcher) {
  const base::Duration period = std::chrono::milliseconds{10};
#ifdef OCM_MUST_FAIL
  dispatcher.start(0, period, 3, base::Time{});
#else
  dispatcher.start(0, period, scheduling::Level::low, base::Time{});
#endif
}
