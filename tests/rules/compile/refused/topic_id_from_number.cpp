// A topic's number is said to be one: it is not mixed up with an identifier or a length.
// expect g++: could not convert '5'
// expect clang++: no viable conversion from 'int'
#include "ocm/protocol/request.hpp"

#ifdef OCM_MUST_FAIL
constexpr auto frame = ocm::protocol::once(0x05);
#else
constexpr auto frame = ocm::protocol::once(ocm::protocol::TopicId{0x05});
#endif
static_assert(frame.id == 0x205);
