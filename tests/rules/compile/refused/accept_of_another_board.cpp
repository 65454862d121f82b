// The lights are on another board.
// expect: this topic belongs to another board
#include "ocm/controller/controller.hpp"
#include "ocm/topics/amiro.hpp"

struct Can {
  ocm::base::Result<bool> send(const ocm::can::Frame&) { return true; }
};
using ocm::base::Result;
using Board = ocm::controller::Controller<amiro::DiWheelDrive, Can>;

void set_up(Board& board) {
#ifdef OCM_MUST_FAIL
  board.accept<amiro::Led>([](std::uint8_t, const amiro::Led&) {});
#else
  board.accept<amiro::Motors>([](const amiro::Motors&) {});
#endif
}
