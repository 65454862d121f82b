// A big-endian field goes on in the next byte, of which the last has none.
// expect: the field does not fit into eight bytes
#include "ocm/protocol/codec.hpp"

using ocm::protocol::ByteOrder;

#ifdef OCM_MUST_FAIL
using Field = ocm::protocol::Bits<std::uint16_t, 59, 12, ByteOrder::big>;
#else
using Field = ocm::protocol::Bits<std::uint16_t, 51, 12, ByteOrder::big>;
#endif
static_assert(Field::max == 4'095);
