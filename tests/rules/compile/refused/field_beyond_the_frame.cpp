// Sixteen bits from bit 56 on would end in a ninth byte.
// expect: the field does not fit into eight bytes
#include "ocm/protocol/codec.hpp"

#ifdef OCM_MUST_FAIL
using Field = ocm::protocol::Bits<std::uint16_t, 56>;
#else
using Field = ocm::protocol::Bits<std::uint16_t, 48>;
#endif
static_assert(Field::max == 65'535);
