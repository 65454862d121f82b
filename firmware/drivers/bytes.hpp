/// Two bytes and the number that they are, in the two orders that parts use.
#pragma once

#include <cstdint>

namespace ocm::firmware::drivers {

[[nodiscard]] constexpr std::uint16_t join(std::uint8_t high, std::uint8_t low) noexcept {
  return static_cast<std::uint16_t>(high << 8 | low);
}
[[nodiscard]] constexpr std::uint8_t high_byte(std::uint16_t word) noexcept {
  return static_cast<std::uint8_t>(word >> 8);
}
[[nodiscard]] constexpr std::uint8_t low_byte(std::uint16_t word) noexcept {
  return static_cast<std::uint8_t>(word & 0xFF);
}

/// Two's complement, as every part here has it.
[[nodiscard]] constexpr std::int16_t join_signed(std::uint8_t high, std::uint8_t low) noexcept {
  return static_cast<std::int16_t>(join(high, low));
}
static_assert(join_signed(0xFF, 0xFF) == -1);
static_assert(join_signed(0x80, 0x00) == -32768);

}  // namespace ocm::firmware::drivers
