// A frame of a topic is not the topic: it cannot be asked for alone.
// expect g++: no matching function for call to 'sample_frame(
// expect clang++: no matching function for call to 'sample_frame'
#include "ocm/protocol/message.hpp"
#include "ocm/topics/amiro.hpp"

#ifdef OCM_MUST_FAIL
constexpr auto frame = ocm::protocol::sample_frame(amiro::MagnetometerY{});
#else
constexpr auto frame = ocm::protocol::sample_frame(amiro::Magnetometer{}, ocm::protocol::Priority::medium, 1);
#endif
static_assert(frame.id == 0x606);
