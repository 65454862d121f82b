#include "ocm/can/slcan_codec.hpp"

#include <catch2/catch.hpp>

#include "unit/can/slcan_vectors.hpp"

namespace can_slcan_codec_test {

namespace slcan = ocm::can::slcan;
using ocm::base::Error;
using ocm::can::Format;
using ocm::can::Frame;
using ocm::test::slcan::body;
using ocm::test::slcan::vectors;

TEST_CASE("slcan: the line of a frame, both ways") {
  for (const auto& v : vectors) {
    CHECK(slcan::encode(v.frame)->view() == v.line);
    const auto parsed = slcan::detail::parse_frame(body(v.line));
    REQUIRE(parsed);
    CHECK(parsed->frame == v.frame);
    CHECK(parsed->end == body(v.line).size());
  }
}

static_assert(slcan::encode({0x100, 2, {0x11, 0x33}}, 0x2B4C % 60'000)->view() == "t100211332B4C\r");
static_assert(slcan::encode({0x100, 0, {}}, 59'999)->view() == "t1000EA5F\r");  // the last of a minute
static_assert(slcan::encode({0x100, 0, {}}, 60'000)->view() == "t10000000\r");
static_assert(slcan::encode({0x800, 0, {}}).error == Error::bad_identifier);
static_assert(slcan::encode({0x100, 9, {}}).error == Error::bad_length);
static_assert(slcan::encode({0x004, 8, {}, Format::error}).error == Error::bad_identifier);
static_assert(slcan::encode({0x1FFF'FFFF, 8, {}, Format::extended}, 1)->view().size() ==
              slcan::max_frame_line + 1);

// [CAN232 manual, command S]
static_assert(*slcan::bit_rate_code(10'000) == 0 && *slcan::bit_rate_code(125'000) == 4 &&
              *slcan::bit_rate_code(500'000) == 6 && *slcan::bit_rate_code(1'000'000) == 8);
static_assert(*slcan::bit_rate_code(20'000) == 1 && *slcan::bit_rate_code(50'000) == 2 &&
              *slcan::bit_rate_code(100'000) == 3 && *slcan::bit_rate_code(250'000) == 5 &&
              *slcan::bit_rate_code(800'000) == 7);
static_assert(slcan::bit_rate_code(83'333).error == Error::out_of_range);
static_assert(slcan::nearest_bit_rate(83'333) == 100'000 && slcan::nearest_bit_rate(650'000) == 500'000 &&
              slcan::nearest_bit_rate(0) == 10'000 && slcan::nearest_bit_rate(UINT32_MAX) == 1'000'000);
// 03 1C is 125 kbit/s [CAN232 manual, command s]; 00 14 is 1 Mbit/s, 00 1C 500 kbit/s for an SJA1000 at 16
// MHz
static_assert(slcan::bit_rate_of_registers(0x03, 0x1C) == 125'000);
static_assert(slcan::bit_rate_of_registers(0x00, 0x14) == 1'000'000);
static_assert(slcan::bit_rate_of_registers(0x00, 0x1C) == 500'000);
// 8 clocks a quantum, 20 quanta a bit; all bits set: 128 and 25, whatever SJW and SAM are
static_assert(slcan::bit_rate_of_registers(0x03, 0x2F) == 100'000);
static_assert(slcan::bit_rate_of_registers(0xFF, 0xFF) == 5'000);
static_assert(slcan::bit_rate_of_registers(0x3F, 0x7F) == 5'000);

}  // namespace can_slcan_codec_test
