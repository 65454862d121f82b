// A controller has as many tasks of its own as its type says.
// expect: the controller has fewer tasks
#include "ocm/controller/controller.hpp"
#include "ocm/topics/amiro.hpp"

struct Can {
  ocm::base::Result<bool> send(const ocm::can::Frame&) { return true; }
};
using ocm::scheduling::Level;
using Board = ocm::controller::Controller<amiro::DiWheelDrive, Can, ocm::scheduling::Cooperative, 1>;

void set_up(Board& board) {
#ifdef OCM_MUST_FAIL
  board.every<1>(std::chrono::milliseconds{10}, Level::high, [] {});
#else
  board.every<0>(std::chrono::milliseconds{10}, Level::high, [] {});
#endif
}
