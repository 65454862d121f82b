/// An update in one packet, with a sequence number and a CRC, in place of two to four packets of text: no
/// splice looks whole, and what is lost is known. Every byte of it is 0x80 or more and every character of a
/// sentence less, so that the two never look alike, and none is NUL, `*`, `{`, `[` or a line feed, on which
/// dongles and terminals act.
///
/// Bytes, each 0x80 plus seven bits: tag 0x31, then 112 bits most significant first (sequence 8, x 16, y 16,
/// heading 16, servo 8, s1 to s4 12 each), then five bits of 0 and the CRC-16 of the 17 bytes before.
///
/// No heap, constexpr. O(bits) a packet; a reader takes 76 bytes. A packet that is damaged, torn, repeated or
/// late is not passed on, and counted.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/base/crc16.hpp"
#include "ocm/base/result.hpp"
#include "ocm/mapper/link/packet.hpp"
#include "ocm/mapper/link/sentence.hpp"

namespace ocm::mapper::link {

/// Whether a byte of a stream is of a packed update; if not, of a sentence or a prefix.
[[nodiscard]] constexpr bool is_packed(std::uint8_t byte) noexcept {
  return byte >= 0x80;
}

struct PackedUpdate {
  std::uint8_t sequence = 0;  ///< one more than the last, 0 behind 255
  Update update{};
  friend constexpr bool operator==(const PackedUpdate&, const PackedUpdate&) = default;
};

namespace detail {

inline constexpr std::size_t packed_body = 17;  ///< bytes that the CRC is over

/// Seven bits a byte, behind each other, most significant first.
class SevenBits {
 public:
  constexpr explicit SevenBits(std::size_t first_byte) noexcept : bit_(first_byte * 7) {}
  constexpr void put(Packet& packet, std::uint32_t value, unsigned width) noexcept {
    for (; width > 0; --width, ++bit_) {
      std::uint8_t& byte = packet.data[bit_ / 7];
      byte = static_cast<std::uint8_t>(byte | 0x80 | (value >> (width - 1) & 1U) << (6 - bit_ % 7));
    }
  }
  [[nodiscard]] constexpr std::uint32_t get(std::span<const std::uint8_t, max_packet> bytes,
                                            unsigned width) noexcept {
    std::uint32_t value = 0;
    for (; width > 0; --width, ++bit_) value = value << 1 | (bytes[bit_ / 7] >> (6 - bit_ % 7) & 1U);
    return value;
  }

 private:
  std::size_t bit_;
};

}  // namespace detail

/// Error::out_of_range when a field is.
[[nodiscard]] constexpr base::Result<Packet> pack(const PackedUpdate& packed) noexcept {
  Packet packet;
  packet.size = max_packet;
  packet.data[0] = packed_tag;
  detail::SevenBits bits{1};
  bits.put(packet, packed.sequence, packed_sequence_bits);
  for (std::size_t i = 0; i < Update::fields.size(); ++i) {
    const auto& field = Update::fields[i];
    const std::int16_t number = packed.update.*field.member;
    if (number < field.min || number > field.max) return base::Error::out_of_range;
    bits.put(packet, static_cast<std::uint16_t>(number), packed_widths[i]);
  }
  bits.put(packet, base::crc16(packet.bytes().first(detail::packed_body)), 21);
  return packet;
}

/// Error::bad_syntax: no packed update, or damaged; out_of_range: whole, but a field is not within its range.
[[nodiscard]] constexpr base::Result<PackedUpdate> unpack(
    std::span<const std::uint8_t, max_packet> bytes) noexcept {
  if (bytes[0] != packed_tag || !std::all_of(bytes.begin(), bytes.end(), is_packed))
    return base::Error::bad_syntax;
  if (detail::SevenBits{detail::packed_body}.get(bytes, 21) != base::crc16(bytes.first(detail::packed_body)))
    return base::Error::bad_syntax;
  detail::SevenBits bits{1};
  PackedUpdate packed;
  packed.sequence = static_cast<std::uint8_t>(bits.get(bytes, packed_sequence_bits));
  for (std::size_t i = 0; i < Update::fields.size(); ++i) {
    const auto& field = Update::fields[i];
    const auto number = static_cast<std::int16_t>(bits.get(bytes, packed_widths[i]));
    if (number < field.min || number > field.max) return base::Error::out_of_range;
    packed.update.*field.member = number;
  }
  return packed;
}

/// What was not passed on, and why. They wrap.
struct PackedFaults {
  std::uint32_t corrupt = 0;       ///< 20 bytes that begin like an update and are none
  std::uint32_t torn = 0;          ///< text began before an update was whole
  std::uint32_t stray = 0;         ///< bytes outside of any; not in `total()`
  std::uint32_t lost = 0;          ///< sequence numbers that never came
  std::uint32_t repeated = 0;      ///< the same number again
  std::uint32_t late = 0;          ///< an older number
  std::uint32_t out_of_range = 0;  ///< whole, but a field cannot be so

  [[nodiscard]] constexpr std::uint32_t total() const noexcept {
    return corrupt + torn + lost + repeated + late + out_of_range;
  }
  friend constexpr bool operator==(const PackedFaults&, const PackedFaults&) = default;
};

/// Makes updates of the bytes of a stream for which `is_packed`.
class PackedReader {
 public:
  /// Whether the byte completes an update, which is then `packed()`.
  constexpr bool feed(std::uint8_t byte) noexcept {
    if (buffer_.size == 0 && byte != packed_tag) {
      ++faults_.stray;
      return false;
    }
    (void)buffer_.push(byte);
    if (!buffer_.full()) return false;
    const auto packed = unpack(std::span<const std::uint8_t, max_packet>{buffer_.data});
    if (packed.error == base::Error::bad_syntax) {
      ++faults_.corrupt;
      resynchronise();
      return false;
    }
    buffer_.size = 0;
    if (!packed) return ++faults_.out_of_range, false;
    return in_order(*packed);
  }
  /// Text has come: what was begun is torn.
  constexpr void interrupt() noexcept {
    if (buffer_.size != 0) ++faults_.torn;
    buffer_.size = 0;
  }
  /// A new link, on which the robot's count restarts: any number may be the first.
  constexpr void restart() noexcept {
    interrupt();
    started_ = false;
  }
  [[nodiscard]] constexpr const PackedUpdate& packed() const noexcept { return packed_; }
  [[nodiscard]] constexpr const PackedFaults& faults() const noexcept { return faults_; }
  /// Updates passed on; it wraps.
  [[nodiscard]] constexpr std::uint32_t heard() const noexcept { return heard_; }

 private:
  /// An update may begin within what was taken for one.
  constexpr void resynchronise() noexcept {
    const auto* end = buffer_.data.begin() + buffer_.size;
    const auto* begin = std::find(buffer_.data.begin() + 1, buffer_.data.begin() + buffer_.size, packed_tag);
    faults_.stray += static_cast<std::uint32_t>(begin - buffer_.data.begin());
    std::uint8_t kept = 0;
    for (; begin != end; ++begin) buffer_.data[kept++] = *begin;
    buffer_.size = kept;
  }
  [[nodiscard]] constexpr bool in_order(const PackedUpdate& packed) noexcept {
    const auto ahead = static_cast<std::uint8_t>(packed.sequence - packed_.sequence);
    if (started_ && ahead == 0) return ++faults_.repeated, false;
    if (started_ && ahead >= 128) return ++faults_.late, false;
    if (started_) faults_.lost += ahead - 1U;
    started_ = true;
    packed_ = packed;
    ++heard_;
    return true;
  }

  Packet buffer_{};
  PackedUpdate packed_{};
  PackedFaults faults_{};
  std::uint32_t heard_ = 0;
  bool started_ = false;
};

}  // namespace ocm::mapper::link
