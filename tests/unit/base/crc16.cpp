#include "ocm/base/crc16.hpp"

#include <array>
#include <cstdint>

#include <catch2/catch.hpp>

namespace base_crc16_test {

using ocm::base::crc16;

// CRC-16/IBM-3740 by hand: the start value alone, and one byte more.
static_assert(crc16({}) == 0xFFFF);
static_assert(crc16(std::array<std::uint8_t, 1>{0x00}) == 0xE1F0);
static_assert(crc16(std::array<std::uint8_t, 1>{0xFF}) == 0xFF00);

TEST_CASE("CRC-16: appended, it leaves nothing; every error of one or two bits is seen") {
  std::array<std::uint8_t, 20> bytes{};
  for (std::size_t i = 0; i < 18; ++i) bytes[i] = static_cast<std::uint8_t>(37 * i + 11);
  const std::uint16_t crc = crc16(std::span{bytes}.first<18>());
  bytes[18] = static_cast<std::uint8_t>(crc >> 8);
  bytes[19] = static_cast<std::uint8_t>(crc & 0xFF);
  REQUIRE(crc16(bytes) == 0);
  const auto flip = [&](std::size_t bit) {
    bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ 1U << bit % 8);
  };
  for (std::size_t a = 0; a < 160; ++a) {
    flip(a);
    CHECK(crc16(bytes) != 0);
    for (std::size_t b = a + 1; b < 160; ++b) {
      flip(b);
      CAPTURE(a, b);
      REQUIRE(crc16(bytes) != 0);
      flip(b);
    }
    flip(a);
  }
}

}  // namespace base_crc16_test
