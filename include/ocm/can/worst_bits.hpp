/// The exact worst case of a frame's length by identifier and number of data bytes: the most bits that any
/// content can make it, with the stuff bits of header, data and CRC, and three bits of intermission.
///
/// A frame's length is a function of its bits from left to right, and what is to come depends on little: the
/// CRC register (15 bits), the level and the length of the present run of equal bits (2 x 4). Going backwards
/// from the end of the CRC, "the most stuff bits still to come" is therefore a table of 2^18 numbers, and one
/// pass over 64 data bits serves every identifier and every length. The header then is a walk along one path.
///
/// For hosts: 2.25 MiB, to be put on the heap by the caller, and about 20 ms to build; a question then
/// takes 20 to 40 steps. The closed bound, can::worst_frame_bits, is up to 7 bits longer and needs nothing.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "ocm/can/frame.hpp"
#include "ocm/can/length.hpp"

namespace ocm::can {

class WorstBits {
 public:
  /// All of the pass, about 2.1 million steps.
  WorstBits() noexcept {
    for (std::size_t crc = 0; crc < crcs; ++crc)
      for (unsigned run = 0; run < runs; ++run)
        after_[0][crc] |= std::uint64_t{stuffed_crc(static_cast<std::uint16_t>(crc), run)} << 8 * run;
    for (std::size_t bytes = 1; bytes <= max_dlc; ++bytes) {
      Layer& layer = after_[bytes];
      layer = after_[bytes - 1];
      for (int pair = 0; pair < 4; ++pair) {
        before_a_bit(layer, scratch_);
        before_a_bit(scratch_, layer);
      }
    }
  }

  /// The most bits that a frame of this identifier and length can take, intermission included; 0 for a frame
  /// that cannot exist. `dlc`: of a remote frame the length that it asks for.
  [[nodiscard]] unsigned bits(std::uint32_t id, Format format, std::uint8_t dlc) const noexcept {
    const Frame frame{.id = id, .dlc = dlc, .format = format};
    if (format == Format::error || !validate(frame)) return 0;
    const Walk walk = header(frame);
    return walk.bits + static_cast<unsigned>(8 * frame.bytes().size()) + 15 + trailer_bits +
           intermission_bits + most(walk, frame.bytes().size());
  }

  /// The most that any identifier can take that differs from `id` in bits of `free` alone: a parameter group
  /// of J1939, from any source. 2^(bits of `free`) steps.
  [[nodiscard]] unsigned bits_of_any(std::uint32_t id, std::uint32_t free, Format format,
                                     std::uint8_t dlc) const noexcept {
    unsigned greatest = 0;
    for (std::uint32_t part = free;; part = (part - 1) & free) {
      greatest = std::max(greatest, bits((id & ~free) | part, format, dlc));
      if (part == 0) return greatest;
    }
  }

  /// A frame that takes so many bits: the lowest of those, its data read as one number from byte 0 on.
  [[nodiscard]] Frame witness(std::uint32_t id, Format format, std::uint8_t dlc) const noexcept {
    Frame frame{.id = id, .dlc = dlc, .format = format};
    if (format == Format::error || !validate(frame)) return frame;
    Walk walk = header(frame);
    const std::size_t count = frame.bytes().size();
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t left = count - 1 - i;
      const unsigned goal = most(walk, left + 1);
      for (unsigned value = 0; value <= 0xFF; ++value) {
        Walk further = walk;
        further.bits = 0;
        for (unsigned bit = 8; bit-- > 0;) further.add((value >> bit & 1) != 0);
        // Its bits count the eight of the byte, too.
        if (further.bits - 8 + most(further, left) != goal) continue;
        frame.data[i] = static_cast<std::uint8_t>(value);
        walk = further;
        break;
      }
    }
    return frame;
  }

 private:
  static constexpr std::size_t crcs = std::size_t{1} << 15;
  /// Level 0 with a run of 1 to 4 equal bits, then level 1; a run of five has its stuff bit already, which
  /// starts a run of one.
  static constexpr unsigned runs = 8;
  /// A register a word, a run a byte, the first in the lowest: a step is a few operations on the word.
  using Layer = std::array<std::uint64_t, crcs>;

  static constexpr std::uint16_t shifted(std::uint16_t crc, bool bit) noexcept {
    const bool feedback = bit != ((crc >> 14 & 1) != 0);
    return static_cast<std::uint16_t>((crc << 1 & 0x7FFF) ^ (feedback ? crc15_polynomial : 0));
  }

  /// The run after one more bit; a stuff bit that follows is counted.
  static constexpr unsigned followed(unsigned run, bool bit, unsigned& stuffed) noexcept {
    if ((run >= 4) != bit) return bit ? 4 : 0;
    if (run % 4 != 3) return run + 1;
    ++stuffed;
    return bit ? 0 : 4;
  }

  static constexpr unsigned stuffed_crc(std::uint16_t crc, unsigned run) noexcept {
    unsigned stuffed = 0;
    for (unsigned i = 15; i-- > 0;) run = followed(run, (crc >> i & 1) != 0, stuffed);
    return stuffed;
  }

  /// Where a frame's bits have led to.
  struct Walk {
    std::uint16_t crc = 0;
    unsigned run = 4;  ///< before SOF the bus is recessive; SOF, dominant, starts a run of its own
    unsigned bits = 0;
    constexpr void add(bool bit) noexcept {
      crc = shifted(crc, bit);
      ++bits;
      run = followed(run, bit, bits);
    }
    constexpr void add(std::uint32_t value, unsigned width) noexcept {
      while (width-- > 0) add((value >> width & 1) != 0);
    }
  };

  static constexpr Walk header(const Frame& frame) noexcept {
    Walk walk;
    const bool remote = is_remote(frame.format);
    walk.add(false);  // SOF
    if (is_extended(frame.format)) {
      walk.add(frame.id >> 18, 11);
      walk.add(0b11, 2);  // SRR, IDE
      walk.add(frame.id & 0x3'FFFF, 18);
    } else {
      walk.add(frame.id, 11);
    }
    walk.add(remote);
    walk.add(0, 2);  // IDE and r0, or r1 and r0
    walk.add(frame.dlc, 4);
    return walk;
  }

  [[nodiscard]] unsigned most(const Walk& walk, std::size_t bytes) const noexcept {
    return static_cast<unsigned>(after_[bytes][walk.crc] >> 8 * walk.run & 0xFF);
  }

  /// From "so many bits to come" to one bit more, of either level.
  static void before_a_bit(const Layer& after, Layer& before) noexcept {
    for (std::size_t crc = 0; crc < crcs; ++crc) {
      const std::uint64_t zero = after[shifted(static_cast<std::uint16_t>(crc), false)];
      const std::uint64_t one = after[shifted(static_cast<std::uint16_t>(crc), true)];
      // A zero: runs of zeros grow (the bytes move down), the fourth is stuffed and goes to the first of
      // ones, and runs of ones go to the first of zeros. A one: the same with the halves exchanged.
      const std::uint64_t by_zero =
          (zero >> 8 & 0xFFFF'FFFF) + 0x0100'0000 + ((zero & 0xFF) * 0x0101'0101 << 32);
      const std::uint64_t turned = one >> 32 | one << 32;
      const std::uint64_t by_one =
          ((turned >> 8 & 0xFFFF'FFFF) + 0x0100'0000) << 32 | (turned & 0xFF) * 0x0101'0101;
      before[crc] = greater_bytes(by_zero, by_one);
    }
  }

  /// Byte by byte; all are below 128.
  static constexpr std::uint64_t greater_bytes(std::uint64_t a, std::uint64_t b) noexcept {
    constexpr std::uint64_t high = 0x8080'8080'8080'8080;
    const std::uint64_t not_less = (((a | high) - b) & high) >> 7;  // 1 in each byte where a >= b
    const std::uint64_t mask = (not_less << 8) - not_less;
    return (a & mask) | (b & ~mask);
  }

  /// By the number of data bytes still to come.
  std::array<Layer, max_dlc + 1> after_{};
  Layer scratch_{};
};

}  // namespace ocm::can
