// The priority of a request becomes a level where controller/level.hpp converts it, and nowhere by itself.
// expect g++: cannot convert
// expect clang++: cannot initialize a parameter
#include "ocm/controller/level.hpp"
#include "ocm/scheduling/cooperative.hpp"

using namespace ocm;

void pend(scheduling::Cooperative& port, protocol::Priority priority) {
#ifdef OCM_MUST_FAIL
  port.pend(priority);
#else
  port.pend(controller::level_of(priority));
#endif
}
