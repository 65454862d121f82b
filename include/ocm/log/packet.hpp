/// CAN frames as packets, in the layouts that pcap and pcapng know: LINKTYPE_CAN_SOCKETCAN, and the "cooked"
/// captures of several devices, in which 16 or 20 bytes stand before it. No allocation, no loop but over
/// data.
///
/// A frame is as in linux/can.h: identifier with flags (4 bytes, big endian), length, flags of CAN FD, a
/// reserved byte, the length code of 8 bytes ("len8_dlc"), then 8 bytes of data, 64 with CAN FD. Cooked ones
/// have the identifier in the byte order of the machine that recorded. [tcpdump.org/linktypes, linux/can.h]
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>

#include "ocm/base/swar.hpp"
#include "ocm/log/complaints.hpp"
#include "ocm/log/entry.hpp"

namespace ocm::log {

/// What a packet begins with. The numbers are those of the files.
enum class LinkType : std::uint32_t {
  none = 0,
  linux_cooked = 113,
  can_socketcan = 227,
  linux_cooked2 = 276
};

[[nodiscard]] constexpr bool holds_can(LinkType type) noexcept {
  return type == LinkType::linux_cooked || type == LinkType::can_socketcan || type == LinkType::linux_cooked2;
}

namespace packet {

inline constexpr std::size_t header_size = 8;
inline constexpr std::size_t classic_size = header_size + can::max_dlc;
inline constexpr std::size_t fd_size = header_size + max_fd_length;

inline constexpr std::uint32_t extended_flag = 0x8000'0000;  ///< CAN_EFF_FLAG
inline constexpr std::uint32_t remote_flag = 0x4000'0000;    ///< CAN_RTR_FLAG
inline constexpr std::uint32_t error_flag = 0x2000'0000;     ///< CAN_ERR_FLAG

[[nodiscard]] inline std::uint32_t load32(const char* from) noexcept {
  std::uint32_t word;
  std::memcpy(&word, from, sizeof word);
  return word;
}
[[nodiscard]] inline std::uint32_t load32_big(const char* from) noexcept {
  return base::swar::big_endian(load32(from));
}
[[nodiscard]] inline std::uint32_t load16_big(const char* from) noexcept {
  return load32_big(from) >> 16;
}
[[nodiscard]] inline std::uint8_t load8(const char* from) noexcept {
  return static_cast<std::uint8_t>(*from);
}
inline void store32(char* to, std::uint32_t word) noexcept {
  std::memcpy(to, &word, sizeof word);
}

/// Bytes that `store` writes.
[[nodiscard]] inline std::size_t size_of(const Entry& entry) noexcept {
  return entry.is_fd() ? fd_size : classic_size;
}

[[nodiscard]] constexpr std::uint32_t flags_of(can::Format format) noexcept {
  constexpr std::uint32_t flags[] = {0, extended_flag, remote_flag, extended_flag | remote_flag, error_flag};
  return flags[static_cast<std::size_t>(format)];
}

/// The frame as LINKTYPE_CAN_SOCKETCAN: always 16 or 72 bytes, by which older tools tell CAN FD.
inline void store(char* to, const Entry& entry) noexcept {
  store32(to, base::swar::big_endian(entry.id | flags_of(entry.format)));
  to[4] = static_cast<char>(entry.length);
  to[6] = 0;
  if (!entry.is_fd()) [[likely]] {
    to[5] = 0;
    to[7] = static_cast<char>(entry.raw_dlc);
    std::memcpy(to + header_size, entry.data.data(), can::max_dlc);
    return;
  }
  to[5] = static_cast<char>(entry.flags);
  to[7] = 0;
  std::memcpy(to + header_size, entry.data.data(), entry.length);
  std::memset(to + header_size + entry.length, 0, max_fd_length - entry.length);
}

/// Identifier, format, length, flags and data from the bytes of a frame; the rest of `entry` is left as it
/// is. `id` is the word of the identifier in our byte order. What is wrong with it, or nothing.
[[nodiscard]] inline std::optional<Cause> load_frame(std::string_view bytes, std::uint32_t id, bool is_fd,
                                                     Entry& entry) noexcept {
  const std::uint8_t length = load8(bytes.data() + 4);
  const std::uint8_t flags = load8(bytes.data() + 5);
  // Older recorders did not set the flag: then the size tells.
  is_fd = is_fd || (flags & flag::fd) != 0 || length > can::max_dlc || bytes.size() > classic_size;
  entry.id = id & can::max_extended_id;
  entry.length = length;
  if ((id & error_flag) != 0) {
    entry.format = can::Format::error;
  } else {
    constexpr can::Format formats[] = {can::Format::base, can::Format::base_remote, can::Format::extended,
                                       can::Format::extended_remote};
    entry.format = formats[id >> 30];
    if (!can::is_extended(entry.format) && entry.id > can::max_base_id) return Cause::identifier;
  }
  if (is_fd) {
    // There are no such frames: FD has no remote ones, and controllers report errors as classic ones.
    if ((id & (error_flag | remote_flag)) != 0) return Cause::syntax;
    if (!is_fd_length(length) || header_size + length > bytes.size()) return Cause::length;
    entry.flags = static_cast<std::uint8_t>(flags | flag::fd);
    entry.raw_dlc = 0;
    std::memset(entry.data.data(), 0, can::max_dlc);
    std::memcpy(entry.data.data(), bytes.data() + header_size, length);
    return std::nullopt;
  }
  entry.flags = 0;
  const std::uint8_t raw = load8(bytes.data() + 7);
  const bool any_code = length == can::max_dlc && entry.format != can::Format::error;
  entry.raw_dlc = any_code && raw > can::max_dlc && raw <= 15 ? raw : std::uint8_t{0};
  if (can::is_remote(entry.format)) {
    std::memset(entry.data.data(), 0, can::max_dlc);
    return std::nullopt;
  }
  if (header_size + length > bytes.size()) return Cause::length;  // cut off by the recorder
  // All eight, at once, and away with what is beyond the length.
  char eight[can::max_dlc] = {};
  std::uint64_t data;
  if (bytes.size() >= classic_size) [[likely]]
    data = base::swar::load64(bytes.data() + header_size);
  else
    std::memcpy(eight, bytes.data() + header_size, length), data = base::swar::load64(eight);
  if (length < can::max_dlc) data &= ~(~std::uint64_t{0} << 8 * length);
  std::memcpy(entry.data.data(), &data, sizeof data);
  return std::nullopt;
}

inline constexpr std::uint32_t arphrd_can = 280;       ///< [linux/if_arp.h]
inline constexpr std::uint32_t protocol_can = 0x000C;  ///< [linux/if_ether.h]
inline constexpr std::uint32_t protocol_can_fd = 0x000D;
inline constexpr std::uint32_t sent_by_us = 4;  ///< [linux/if_packet.h]

/// A packet as an entry, but for its time and interface; the direction where the packet says it (a cooked
/// one) and unchanged otherwise. `swapped`: the recorder's byte order is not ours.
[[nodiscard]] inline std::optional<Cause> load(std::string_view bytes, LinkType type, bool swapped,
                                               Entry& entry) noexcept {
  if (type == LinkType::can_socketcan) [[likely]] {
    if (bytes.size() < header_size) return Cause::length;
    return load_frame(bytes, load32_big(bytes.data()), false, entry);
  }
  if (!holds_can(type)) return Cause::unsupported;
  const bool second = type == LinkType::linux_cooked2;
  const std::size_t before = second ? 20 : 16;
  if (bytes.size() < before) return Cause::length;
  const char* const at = bytes.data();
  const std::uint32_t device = load16_big(at + (second ? 8 : 2));
  const std::uint32_t protocol = load16_big(at + (second ? 0 : 14));
  if (device != arphrd_can || (protocol != protocol_can && protocol != protocol_can_fd))
    return Cause::unsupported;
  if (bytes.size() < before + header_size) return Cause::length;
  const std::uint32_t to_whom = second ? load8(at + 10) : load16_big(at);
  entry.direction = to_whom == sent_by_us ? Direction::sent : Direction::received;
  const std::uint32_t id = load32(at + before);
  return load_frame(bytes.substr(before), swapped ? base::swar::big_endian(id) : id,
                    protocol == protocol_can_fd, entry);
}

}  // namespace packet

}  // namespace ocm::log
