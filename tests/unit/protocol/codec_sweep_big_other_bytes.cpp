#include "unit/protocol/codec_sweep.hpp"

namespace protocol_codec_sweep_big_other_bytes_test {

using namespace ocm::test;

// From bit 7 of byte 0 on there is room for 64 bits, from bit 6 for 63, from bit 7 of byte 1 for 56, ...
static_assert(sweep<ByteOrder::big, 16>(std::make_integer_sequence<unsigned, 48>{}) == 1176);

}  // namespace protocol_codec_sweep_big_other_bytes_test
