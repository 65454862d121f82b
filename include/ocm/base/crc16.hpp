/// CRC-16/IBM-3740, also called CCITT-FALSE: polynomial 0x1021, start 0xFFFF, nothing reflected. Finds every
/// error of up to three bits and every burst of up to 16 in messages of this library's sizes. Bit by bit: no
/// table, O(8 bytes).
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace ocm::base {

[[nodiscard]] constexpr std::uint16_t crc16(std::span<const std::uint8_t> bytes) noexcept {
  std::uint32_t crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    crc ^= static_cast<std::uint32_t>(byte) << 8;
    for (int bit = 0; bit < 8; ++bit) crc = (crc << 1 ^ ((crc & 0x8000) != 0 ? 0x1021U : 0U)) & 0xFFFF;
  }
  return static_cast<std::uint16_t>(crc);
}

// The check value that catalogues of CRCs give for "123456789".
static_assert(crc16(std::array<std::uint8_t, 9>{'1', '2', '3', '4', '5', '6', '7', '8', '9'}) == 0x29B1);

}  // namespace ocm::base
