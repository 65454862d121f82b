/// How many bits a CAN FD frame takes on the wire, at each of its two bit rates: header, data, stuff count,
/// CRC, stuff bits as they really fall, acknowledgement, end of frame. [ISO 11898-1:2015, 10.4; CAN with
/// Flexible Data-Rate Specification 1.0, Bosch 2012, chapters 3 and 6]
///
/// The bits of the CRC need not be known: its stuff bits are at fixed places. One pass over at most 560 bits
/// that are stuffed. No table, no heap, constexpr.
#pragma once

#include <cstdint>

#include "ocm/can/any_frame.hpp"
#include "ocm/can/length.hpp"

namespace ocm::can {

/// Bits by bit rate. A frame without bit-rate switch has none at that of the data.
struct FdBits {
  unsigned nominal = 0;  ///< arbitration, acknowledgement, end of frame
  unsigned data = 0;
  friend constexpr bool operator==(const FdBits&, const FdBits&) = default;
};

namespace detail {

/// Counts bits and the stuff bits among them. A stuff bit comes before the bit that follows five equal ones,
/// so that none is behind the last bit: a fixed stuff bit is there in its place.
class FdBitCounter {
 public:
  constexpr void add(std::uint32_t value, unsigned width) noexcept {
    for (unsigned i = width; i-- > 0;) {
      const bool bit = (value >> i & 1) != 0;
      if (run_ == 5) {  // of the other level, and counts for the next run
        ++bits_;
        last_ = !last_;
        run_ = 1;
      }
      ++bits_;
      run_ = bit == last_ ? run_ + 1 : 1;
      last_ = bit;
    }
  }
  [[nodiscard]] constexpr unsigned bits() const noexcept { return bits_; }

 private:
  unsigned bits_ = 0;
  unsigned run_ = 0;
  bool last_ = true;  // the bus is recessive before SOF
};

}  // namespace detail

/// The stuff count, its parity and the CRC (17 bits for up to 16 bytes of data, 21 for more), with a fixed
/// stuff bit before the first bit and behind each fourth. [ISO 11898-1:2015, 10.4.2.6]
[[nodiscard]] constexpr unsigned fd_crc_field_bits(unsigned data_bytes) noexcept {
  const unsigned bits = 4 + (data_bytes <= 16 ? 17 : 21);
  return bits + (bits + 3) / 4;
}

/// Bits from start of frame to the last bit of the end of frame, stuff bits included; without intermission.
/// `frame` is a CAN FD frame.
///
/// The rate changes at the sample points of two bits: BRS begins at the nominal rate and ends at that of the
/// data, the CRC delimiter the other way round. Together they last one bit of each rate, wherever the sample
/// points lie. BRS counts as nominal here, the delimiter as data.
[[nodiscard]] constexpr FdBits fd_frame_bits(const AnyFrame& frame) noexcept {
  detail::FdBitCounter counter;
  const bool switches = (frame.flags & frame_flag::bit_rate_switch) != 0;
  const bool passive = (frame.flags & frame_flag::error_state) != 0;
  counter.add(0, 1);  // SOF
  if (is_extended(frame.format)) {
    counter.add(frame.id >> 18, 11);
    counter.add(0b11, 2);  // SRR, IDE
    counter.add(frame.id & 0x3'FFFF, 18);
    counter.add(0, 1);  // RRS
  } else {
    counter.add(frame.id, 11);
    counter.add(0, 2);  // RRS, IDE
  }
  counter.add(0b10, 2);  // FDF, res
  counter.add(switches ? 1 : 0, 1);
  // No stuff bit is due here: res is dominant, and BRS, if the rate switches, recessive.
  const unsigned until_switch = counter.bits();
  counter.add(passive ? 1 : 0, 1);
  counter.add(fd_dlc(frame.length), 4);
  for (const std::uint8_t byte : frame.bytes()) counter.add(byte, 8);
  const unsigned crc_delimiter = 1;
  const unsigned before_acknowledge =
      counter.bits() + fd_crc_field_bits(static_cast<unsigned>(frame.bytes().size())) + crc_delimiter;
  const unsigned last = trailer_bits - crc_delimiter;
  if (!switches) return {before_acknowledge + last, 0};
  return {until_switch + last, before_acknowledge - until_switch};
}

}  // namespace ocm::can
