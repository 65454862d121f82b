// A bus says whether it took the frame: mailboxes are full at times.
// expect g++: template constraint failure
// expect clang++: constraints not satisfied for class template 'Controller'
#include "ocm/controller/controller.hpp"
#include "ocm/topics/amiro.hpp"

struct Can {
#ifdef OCM_MUST_FAIL
  void send(const ocm::can::Frame&) {}
#else
  ocm::base::Result<bool> send(const ocm::can::Frame&) {
    return true;
  }
#endif
};
using Board = ocm::controller::Controller<amiro::DiWheelDrive, Can>;
static_assert(sizeof(Board) > 0);
