// A set point travels in one frame, so that it comes whole or not at all.
// expect: a set point travels in one frame
#include "ocm/protocol/message.hpp"
#include "ocm/topics/amiro.hpp"

#ifdef OCM_MUST_FAIL
constexpr auto frame = ocm::protocol::command(amiro::Odometry{});
#else
constexpr auto frame = ocm::protocol::command(amiro::Motors{});
#endif
static_assert(frame.dlc == 8);
