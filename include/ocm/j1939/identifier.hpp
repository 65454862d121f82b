/// The identifier of 29 bits as SAE J1939-21 reads it: how urgent, what about, to whom, from whom.
///
///     bit 28..26  priority     0 is the most urgent
///     bit 25..24  EDP, DP      two more bits of the parameter group's number
///     bit 23..16  PDU format   below 240 the message goes to one address (PDU1), else to all (PDU2)
///     bit 15..8   PDU specific the destination (PDU1), or the last byte of the group's number (PDU2)
///     bit 7..0    source address
#pragma once

#include <cstdint>

namespace ocm::j1939 {

inline constexpr std::uint8_t global_address = 255;  ///< to all
inline constexpr std::uint8_t null_address = 254;    ///< of a node that has none yet

/// Whether messages of a parameter group go to one address, which is no part of the group's number.
[[nodiscard]] constexpr bool is_pdu1(std::uint32_t pgn) noexcept {
  return (pgn >> 8 & 0xFF) < 240;
}

struct Identifier {
  std::uint8_t priority = 6;
  std::uint32_t pgn = 0;  ///< 18 bits; the last byte of a PDU1 group is 0
  std::uint8_t destination = global_address;
  std::uint8_t source = null_address;

  [[nodiscard]] constexpr std::uint32_t encode() const noexcept {
    const std::uint32_t group = is_pdu1(pgn) ? (pgn & 0x3'FF00) | destination : pgn & 0x3'FFFF;
    return std::uint32_t{priority & 7U} << 26 | group << 8 | source;
  }
  /// Every number of 29 bits is an identifier; higher bits are cut off.
  [[nodiscard]] static constexpr Identifier decode(std::uint32_t id) noexcept {
    const std::uint32_t group = id >> 8 & 0x3'FFFF;
    const auto priority = static_cast<std::uint8_t>(id >> 26 & 7);
    const auto source = static_cast<std::uint8_t>(id);
    if (!is_pdu1(group)) return {priority, group, global_address, source};
    return {priority, group & 0x3'FF00, static_cast<std::uint8_t>(group), source};
  }
  friend constexpr bool operator==(const Identifier&, const Identifier&) = default;
};

/// The number of the parameter group in an identifier.
[[nodiscard]] constexpr std::uint32_t pgn_of(std::uint32_t id) noexcept {
  return Identifier::decode(id).pgn;
}

/// The bits of an identifier that a group's messages have in common. For acceptance filters.
[[nodiscard]] constexpr std::uint32_t mask_of(std::uint32_t pgn) noexcept {
  return is_pdu1(pgn) ? 0x03FF'0000 : 0x03FF'FF00;
}

}  // namespace ocm::j1939
