#include "unit/protocol/codec_sweep.hpp"

namespace protocol_codec_sweep_little_other_bytes_test {

using namespace ocm::test;

// From bit b of the frame on there is room for 64 - b bits.
static_assert(sweep<ByteOrder::little, 16>(std::make_integer_sequence<unsigned, 48>{}) == 1176);

}  // namespace protocol_codec_sweep_little_other_bytes_test
