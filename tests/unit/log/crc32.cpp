#include "ocm/log/crc32.hpp"

#include <string>

#include <catch2/catch.hpp>

namespace log_crc32_test {

using namespace ocm;

TEST_CASE("crc32: the check value, and nothing") {
  CHECK(log::crc32("123456789") == 0xCBF4'3926);  // [Rocksoft model, CRC-32: check]
  CHECK(log::crc32("") == 0);
  CHECK(log::crc32(std::string(32, '\0')) == 0x190A'55AD);  // [zlib's crc32]
  CHECK(log::crc32(std::string(32, '\xFF')) == 0xFF6C'AB0B);
}

TEST_CASE("crc32: bit by bit the same, at every length and cut anywhere") {
  std::string bytes;
  for (int i = 0; i < 67; ++i) bytes += static_cast<char>(i * 37 + 11);
  std::uint32_t slow = 0xFFFF'FFFF;
  for (std::size_t size = 0; size <= bytes.size(); ++size) {
    REQUIRE(log::crc32(bytes.substr(0, size)) == ~slow);
    for (std::size_t cut = 0; cut <= size; ++cut)
      REQUIRE(log::crc32(bytes.substr(cut, size - cut), log::crc32(bytes.substr(0, cut))) == ~slow);
    if (size == bytes.size()) break;
    slow ^= static_cast<std::uint8_t>(bytes[size]);
    for (int bit = 0; bit < 8; ++bit) slow = slow >> 1 ^ ((slow & 1) != 0 ? 0xEDB8'8320 : 0);
  }
}

}  // namespace log_crc32_test
