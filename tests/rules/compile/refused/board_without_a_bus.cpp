// A board's bus outlives it: one made for the call does not.
// expect g++: cannot bind non-const lvalue reference
// expect clang++: no matching constructor for initialization
#include "ocm/controller/controller.hpp"
#include "ocm/topics/amiro.hpp"

struct Can {
  ocm::base::Result<bool> send(const ocm::can::Frame&) { return true; }
};
using ocm::base::Result;
using Board = ocm::controller::Controller<amiro::DiWheelDrive, Can>;

void set_up(Can& can) {
#ifdef OCM_MUST_FAIL
  Board board{Can{}};
#else
  Board board{can};
#endif
  board.poll(ocm::base::Time{});
  static_cast<void>(can);
}
