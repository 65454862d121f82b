// Twelve bits do not go into eight.
// expect: the type is too narrow for the field
#include "ocm/protocol/codec.hpp"

#ifdef OCM_MUST_FAIL
using Field = ocm::protocol::Bits<std::uint8_t, 0, 12>;
#else
using Field = ocm::protocol::Bits<std::uint16_t, 0, 12>;
#endif
static_assert(Field::position.width == 12);
