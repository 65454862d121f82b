// With a system's port the levels have contexts of their own: no poll.
// expect g++: no matching function
// expect clang++: invalid reference to function 'poll'
#include "ocm/controller/controller.hpp"
#include "ocm/topics/amiro.hpp"

struct Can {
  ocm::base::Result<bool> send(const ocm::can::Frame&) { return true; }
};
struct Guard {
  ~Guard() {}
};
struct Rtos {
  ocm::base::Time now();
  void arm(ocm::base::Time);
  void pend(ocm::scheduling::Level);
  Guard lock();
};

void turn(ocm::controller::Controller<amiro::LightRing, Can, Rtos>& board) {
#ifdef OCM_MUST_FAIL
  board.poll(ocm::base::Time{});
#else
  board.expire();
#endif
}
