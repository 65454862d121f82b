// A priority has a name: 0 is the most urgent, and who would know?
// expect g++: cannot convert 'int' to 'ocm::protocol::Priority'
// expect clang++: cannot initialize a member subobject of type 'ocm::protocol::Priority'
#include "ocm/protocol/identifier.hpp"

using namespace ocm::protocol;

#ifdef OCM_MUST_FAIL
constexpr Identifier id{Direction::command, 0, TopicId{0x05}};
#else
constexpr Identifier id{Direction::command, Priority::urgent, TopicId{0x05}};
#endif
static_assert(id.encode() == 0x005);
