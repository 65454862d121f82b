#include "unit/protocol/codec_sweep.hpp"

TEST_CASE("every little-endian field that starts in bytes 1 to 2") {
  using namespace ocm::test;
  // 64 widths at start 0, 63 at start 1, ...
  CHECK(sweep<ByteOrder::little, 8>(std::make_integer_sequence<unsigned, 16>{}) == 904 - 16 * 8);
}
