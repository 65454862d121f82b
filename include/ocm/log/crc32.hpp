/// The CRC-32 of gzip, PNG, Ethernet and MCAP: sixteen bytes a step, with 16 KiB of tables. Cannot fail.
/// [ISO 3309; RFC 1952, section 8]
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace ocm::log {

namespace detail {

inline constexpr std::size_t crc32_step = 16;

/// Table n: what a byte does to the sum when n more bytes follow it.
inline constexpr auto crc32_tables = [] {
  constexpr std::uint32_t polynomial = 0xEDB8'8320;  // 0x04C11DB7, the lowest bit first
  std::array<std::array<std::uint32_t, 256>, crc32_step> tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t sum = byte;
    for (int bit = 0; bit < 8; ++bit) sum = sum >> 1 ^ ((sum & 1) != 0 ? polynomial : 0);
    tables[0][byte] = sum;
  }
  for (std::size_t n = 1; n < crc32_step; ++n)
    for (std::size_t byte = 0; byte < 256; ++byte)
      tables[n][byte] = tables[n - 1][byte] >> 8 ^ tables[0][tables[n - 1][byte] & 0xFF];
  return tables;
}();

}  // namespace detail

/// Of `bytes` behind others whose sum is `before`.
[[nodiscard]] inline std::uint32_t crc32(std::string_view bytes, std::uint32_t before = 0) noexcept {
  static_assert(std::endian::native == std::endian::little);
  const auto& tables = detail::crc32_tables;
  std::uint32_t sum = ~before;
  const char* at = bytes.data();
  std::size_t left = bytes.size();
  for (; left >= detail::crc32_step; left -= detail::crc32_step, at += detail::crc32_step) {
    std::uint32_t words[4];
    std::memcpy(words, at, sizeof words);
    words[0] ^= sum;
    sum = 0;
    for (std::size_t i = 0; i < 4; ++i)
      sum ^= tables[15 - 4 * i][words[i] & 0xFF] ^ tables[14 - 4 * i][words[i] >> 8 & 0xFF] ^
             tables[13 - 4 * i][words[i] >> 16 & 0xFF] ^ tables[12 - 4 * i][words[i] >> 24];
  }
  for (; left > 0; --left, ++at) sum = sum >> 8 ^ tables[0][(sum ^ static_cast<std::uint8_t>(*at)) & 0xFF];
  return ~sum;
}

}  // namespace ocm::log
