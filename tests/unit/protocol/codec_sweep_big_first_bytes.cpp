#include "unit/protocol/codec_sweep.hpp"

namespace protocol_codec_sweep_big_first_bytes_test {

using namespace ocm::test;

// From bit 7 of byte 0 on there is room for 64 bits, from bit 6 for 63, from bit 7 of byte 1 for 56, ...
static_assert(sweep<ByteOrder::big, 0>(std::make_integer_sequence<unsigned, 16>{}) == 904);

}  // namespace protocol_codec_sweep_big_first_bytes_test
