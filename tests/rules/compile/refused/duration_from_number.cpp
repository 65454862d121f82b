// A period of 500 what?
// expect g++: could not convert '500'
// expect clang++: no viable conversion from 'int'
#include "ocm/protocol/request.hpp"

using namespace std::chrono_literals;

#ifdef OCM_MUST_FAIL
constexpr auto frame = ocm::protocol::publish_every(ocm::protocol::TopicId{0x08}, 500);
#else
constexpr auto frame = ocm::protocol::publish_every(ocm::protocol::TopicId{0x08}, 500ms);
#endif
static_assert(frame.ok());
