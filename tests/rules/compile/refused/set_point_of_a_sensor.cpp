// A sensor takes requests, not set points.
// expect: only an actuator takes set points
#include "ocm/protocol/message.hpp"
#include "ocm/topics/amiro.hpp"

#ifdef OCM_MUST_FAIL
constexpr auto frame = ocm::protocol::command(amiro::Gyroscope{});
#else
constexpr auto frame = ocm::protocol::command(amiro::Motors{});
#endif
static_assert(frame.dlc > 0);
