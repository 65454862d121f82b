// A bus that is full takes no frame: the sender must know.
// expect g++: ignoring return
// expect clang++: ignoring return value of
#include "ocm/client/robot.hpp"

struct Bus {
  ocm::base::Result<bool> send(const ocm::can::Frame&) { return true; }
  ocm::base::Result<ocm::can::Received> receive(ocm::base::Duration) { return ocm::base::Error::timed_out; }
};

bool greet(ocm::client::Robot<Bus>& robot, const ocm::can::Frame& frame) {
#ifdef OCM_MUST_FAIL
  robot.send(frame);
#endif
  return robot.send(frame).ok();
}
