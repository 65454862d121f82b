// What is read for a topic is a sample of this topic.
// expect g++: cannot convert
// expect clang++: no matching member function for call to 'serve'
#include "ocm/controller/controller.hpp"
#include "ocm/topics/amiro.hpp"

struct Can {
  ocm::base::Result<bool> send(const ocm::can::Frame&) { return true; }
};
using ocm::base::Result;
using Board = ocm::controller::Controller<amiro::DiWheelDrive, Can>;

void set_up(Board& board) {
#ifdef OCM_MUST_FAIL
  board.serve<amiro::Gyroscope>([] { return Result<amiro::Accelerometer>{amiro::Accelerometer{}}; });
#else
  board.serve<amiro::Gyroscope>([] { return Result<amiro::Gyroscope>{amiro::Gyroscope{}}; });
#endif
}
