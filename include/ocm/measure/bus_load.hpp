/// How much of its time a bus carries frames: each counted with its own stuff bits and the intermission, on
/// average and in the worst 100 ms.
///
/// Pure: frames and their times in, shares of time out. 500 bytes and 3 KiB of tables, O(1) a frame; a pause
/// costs at most one step a millisecond of the window. What a CAN controller reports as an error takes time
/// on the bus that is not known: it is not in the load.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "ocm/base/time.hpp"
#include "ocm/can/any_frame.hpp"
#include "ocm/can/fd_bits.hpp"
#include "ocm/can/length.hpp"

namespace ocm::measure {

namespace detail {

/// As can::frame_bits, a byte at a time: a sixth of the work, for 3 KiB of tables that no board has to spare.
class StuffTables {
 public:
  constexpr StuffTables() noexcept {
    for (unsigned state = 0; state < states; ++state)
      for (unsigned byte = 0; byte < 256; ++byte) {
        unsigned at = state, stuffed = 0;
        for (unsigned i = 8; i-- > 0;) at = step(at, (byte >> i & 1) != 0, stuffed);
        after_[state][byte] = static_cast<std::uint8_t>(at | stuffed << 4);
      }
    for (unsigned byte = 0; byte < 256; ++byte) {
      unsigned crc = byte << 7;
      for (int i = 0; i < 8; ++i) crc = (crc & 0x4000) != 0 ? crc << 1 ^ can::crc15_polynomial : crc << 1;
      crc_[byte] = static_cast<std::uint16_t>(crc & 0x7FFF);
    }
  }

  /// Bits of a frame from start of frame to the last bit of the CRC.
  [[nodiscard]] constexpr unsigned bits(const can::Frame& frame) const noexcept {
    const std::uint64_t rtr = can::is_remote(frame.format) ? 1 : 0;
    const bool extended = can::is_extended(frame.format);
    // Start of frame, which is 0, identifier, RTR and so on, and the length code.
    const std::uint64_t head = extended ? (std::uint64_t{frame.id} >> 18) << 27 | std::uint64_t{0b11} << 25 |
                                              (std::uint64_t{frame.id} & 0x3'FFFF) << 7 | rtr << 6 | frame.dlc
                                        : std::uint64_t{frame.id} << 7 | rtr << 6 | frame.dlc;
    const unsigned head_bits = extended ? 39 : 19;
    unsigned state = recessive, stuffed = 0, crc = 0;
    // Whole bytes: what is put in front ends as the bus is before a frame, and changes nothing in a CRC that
    // begins with zero if it is zeros.
    const std::uint64_t idle = extended ? std::uint64_t{0b1} << 39 : std::uint64_t{0b10101} << 19;
    for (unsigned at = (head_bits + 7) / 8 * 8; at != 0;) {
      at -= 8;
      crc = next_crc(crc, static_cast<std::uint8_t>(head >> at));
      take(static_cast<std::uint8_t>((idle | head) >> at), state, stuffed);
    }
    const auto data = frame.bytes();
    for (const std::uint8_t byte : data) {
      crc = next_crc(crc, byte);
      take(byte, state, stuffed);
    }
    // And behind the CRC one of the other level, which no run goes on with.
    const unsigned end = crc << 1 | (~crc & 1U);
    take(static_cast<std::uint8_t>(end >> 8), state, stuffed);
    take(static_cast<std::uint8_t>(end), state, stuffed);
    return head_bits + 8 * static_cast<unsigned>(data.size()) + 15 + stuffed;
  }

 private:
  /// Level of the last bit, and how many of it there were, 0 to 4: after the fifth a stuff bit has come.
  static constexpr unsigned states = 10;
  static constexpr unsigned recessive = 5;  // a 1, and none that counts: before the frame

  [[nodiscard]] static constexpr unsigned step(unsigned state, bool bit, unsigned& stuffed) noexcept {
    const unsigned level = bit ? 5 : 0;
    const bool same = (state >= 5) == bit;
    const unsigned run = same ? state % 5 + 1 : 1;
    if (run < 5) return level + run;
    ++stuffed;
    return (bit ? 0 : 5) + 1;  // the stuff bit is of the other level
  }
  constexpr void take(std::uint8_t byte, unsigned& state, unsigned& stuffed) const noexcept {
    const unsigned after = after_[state][byte];
    state = after & 0xF;
    stuffed += after >> 4;
  }
  [[nodiscard]] constexpr unsigned next_crc(unsigned crc, std::uint8_t byte) const noexcept {
    return (crc << 8 ^ crc_[(crc >> 7 ^ byte) & 0xFF]) & 0x7FFF;
  }

  std::array<std::array<std::uint8_t, 256>, states> after_{};
  std::array<std::uint16_t, 256> crc_{};
};

inline constexpr StuffTables stuff_tables;

}  // namespace detail

/// What a frame takes of the bus until the next one may begin: can::frame_bits and the intermission.
[[nodiscard]] constexpr unsigned bits_on_bus(const can::Frame& frame) noexcept {
  return detail::stuff_tables.bits(frame) + can::trailer_bits + can::intermission_bits;
}

/// Bits a second. Behind its switch a CAN FD frame goes at another rate than before.
struct BitRates {
  std::uint32_t nominal = 0;  ///< above zero
  std::uint32_t data = 0;     ///< 0: not known
};

/// The same of a frame of either kind, to the nearest bit at the nominal rate: of bits at that of the data,
/// more go into the time of one. Nothing where the frame switches and the other rate is not known.
[[nodiscard]] constexpr std::optional<unsigned> bits_on_bus(const can::AnyFrame& frame,
                                                            BitRates rates) noexcept {
  if (const auto classic = frame.classic()) return bits_on_bus(*classic);
  const can::FdBits bits = can::fd_frame_bits(frame);
  if (bits.data == 0) return bits.nominal + can::intermission_bits;
  if (rates.data == 0) return std::nullopt;
  const std::uint64_t data = (std::uint64_t{bits.data} * rates.nominal + rates.data / 2) / rates.data;
  return bits.nominal + can::intermission_bits + static_cast<unsigned>(data);
}

/// Bits in the window of 100 ms that ends now, in steps of a millisecond: a burst is seen whole wherever it
/// begins, and a window has an error of one step.
class BusLoad {
 public:
  static constexpr base::Duration window = std::chrono::milliseconds{100};

  /// `bits` as of bits_on_bus. A frame older than the window begins a new one.
  constexpr void add(base::Time time, unsigned bits) noexcept {
    const std::int64_t slot = std::chrono::floor<std::chrono::milliseconds>(time.time_since_epoch()).count();
    if (any_ && slot > newest_ - steps && slot < newest_ + steps) {
      while (newest_ < slot) {
        ++newest_;
        in_window_ -= at(newest_);
        at(newest_) = 0;
      }
    } else if (!any_ || slot != newest_) {
      slots_ = {};
      in_window_ = 0;
      newest_ = slot;
    }
    any_ = true;
    at(slot) += bits;
    in_window_ += bits;
    if (in_window_ > worst_) {
      worst_ = in_window_;
      worst_until_ = time;
    }
  }
  [[nodiscard]] constexpr std::uint64_t worst_bits() const noexcept { return worst_; }
  /// When the worst window ended.
  [[nodiscard]] constexpr base::Time worst_until() const noexcept { return worst_until_; }

 private:
  static constexpr std::int64_t steps = window / std::chrono::milliseconds{1};

  [[nodiscard]] constexpr std::uint32_t& at(std::int64_t slot) noexcept {
    const std::int64_t place = slot % steps;
    return slots_[static_cast<std::size_t>(place < 0 ? place + steps : place)];
  }

  std::array<std::uint32_t, steps> slots_{};
  std::int64_t newest_ = 0;
  std::uint64_t in_window_ = 0;
  std::uint64_t worst_ = 0;
  base::Time worst_until_{};
  bool any_ = false;
};

/// A share of time: `bits` at `bit_rate` (above zero) within `span`; 0 without a span.
[[nodiscard]] constexpr double share(std::uint64_t bits, base::Duration span,
                                     std::uint32_t bit_rate) noexcept {
  if (span.count() <= 0) return 0;
  return static_cast<double>(bits) * 1e9 / static_cast<double>(bit_rate) / static_cast<double>(span.count());
}

}  // namespace ocm::measure
