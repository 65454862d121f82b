/// How many bits a frame takes on the wire: header, data, CRC, stuff bits as they really fall,
/// acknowledgement, end of frame and the three bits of intermission. [ISO 11898-1, 6.5; Davis, Burns, Bril,
/// Lukkien 2007]
///
/// Cost: one pass over at most 118 stuffed bits. No table.
#pragma once

#include <cstdint>

#include "ocm/can/frame.hpp"

namespace ocm::can {

/// CRC delimiter 1, ACK slot 1, ACK delimiter 1, end of frame 7: never stuffed.
inline constexpr unsigned trailer_bits = 10;
/// Between the end of a frame and the start of the next.
inline constexpr unsigned intermission_bits = 3;
/// x^15 + x^14 + x^10 + x^8 + x^7 + x^4 + x^3 + 1
inline constexpr std::uint16_t crc15_polynomial = 0x4599;

namespace detail {
/// Takes the bits of a frame from SOF on, keeps the CRC and counts the stuff bits.
class BitCounter {
 public:
  constexpr void add(std::uint32_t value, unsigned width, bool in_crc = true) noexcept {
    for (unsigned i = width; i-- > 0;) {
      const bool bit = (value >> i & 1) != 0;
      if (in_crc) {
        const bool feedback = bit != ((crc_ >> 14 & 1) != 0);
        crc_ = static_cast<std::uint16_t>(crc_ << 1 & 0x7FFF);
        if (feedback) crc_ ^= crc15_polynomial;
      }
      ++bits_;
      run_ = bit == last_ ? run_ + 1 : 1;
      last_ = bit;
      if (run_ == 5) {  // a stuff bit of the other level follows, and counts for the next run
        ++bits_;
        last_ = !bit;
        run_ = 1;
      }
    }
  }
  [[nodiscard]] constexpr std::uint16_t crc() const noexcept { return crc_; }
  [[nodiscard]] constexpr unsigned bits() const noexcept { return bits_; }

 private:
  std::uint16_t crc_ = 0;
  unsigned bits_ = 0;
  unsigned run_ = 0;
  bool last_ = true;  // the bus is recessive before SOF
};
}  // namespace detail

/// Bits from start of frame to the last bit of the end of frame, stuff bits included; without intermission.
[[nodiscard]] constexpr unsigned frame_bits(const Frame& frame) noexcept {
  detail::BitCounter counter;
  const std::uint32_t rtr = is_remote(frame.format) ? 1 : 0;
  counter.add(0, 1);  // SOF
  if (is_extended(frame.format)) {
    counter.add(frame.id >> 18, 11);
    counter.add(0b11, 2);  // SRR, IDE
    counter.add(frame.id & 0x3'FFFF, 18);
    counter.add(rtr, 1);
    counter.add(0, 2);  // r1, r0
  } else {
    counter.add(frame.id, 11);
    counter.add(rtr, 1);
    counter.add(0, 2);  // IDE, r0
  }
  counter.add(frame.dlc, 4);
  for (const std::uint8_t byte : frame.bytes()) counter.add(byte, 8);
  const std::uint16_t crc = counter.crc();
  counter.add(crc, 15, false);
  return counter.bits() + trailer_bits;
}

/// Closed bound over all contents, intermission included: 55 + 10 s bits for a base identifier, 80 + 10 s for
/// an extended one, s = data bytes. [Davis et al. 2007, eq. 1]
[[nodiscard]] constexpr unsigned worst_frame_bits(Format format, unsigned data_bytes) noexcept {
  const unsigned g = is_extended(format) ? 54 : 34;
  const unsigned data_bits = is_remote(format) ? 0 : 8 * data_bytes;
  return g + data_bits + 13 + (g + data_bits - 1) / 4;
}

}  // namespace ocm::can
