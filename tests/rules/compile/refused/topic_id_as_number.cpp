// A topic's number is no identifier: direction and priority are missing.
// expect g++: cannot convert 'const ocm::protocol::TopicId'
// expect clang++: no viable conversion from 'const ocm::protocol::TopicId'
#include "ocm/protocol/identifier.hpp"

using namespace ocm::protocol;

constexpr TopicId topic{0x05};
#ifdef OCM_MUST_FAIL
constexpr ocm::can::Frame frame{topic, 0, {}};
#else
constexpr ocm::can::Frame frame{Identifier{Direction::sensor, Priority::medium, topic}.encode(), 0, {}};
#endif
static_assert(frame.id == 0x605);
