/// The most bits that a CAN FD frame takes on the wire, at each of its two bit rates, over all contents: of
/// an identifier, or of any. [ISO 11898-1:2015, 10.4; CAN with Flexible Data-Rate Specification 1.0, Bosch
/// 2012, chapters 3 and 6]
///
/// Unlike that of a classic frame the CRC adds nothing that depends on the content: its stuff bits are at
/// fixed places. And the bits FDF (recessive) and res (dominant) begin runs of their own, so that the stuff
/// bits behind them do not depend on the identifier. So both parts are exact, and the longest of both meet in
/// one frame. The acknowledgement and the CRC delimiter count as one bit each; a bus so long that they last
/// two, which receivers tolerate, needs one nominal bit more for each.
///
/// No table, no heap, constexpr; some 40 steps for an identifier, 600 for any.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "ocm/can/fd_bits.hpp"

namespace ocm::can {

namespace detail {

/// Stuff bits before `count` bits that can be chosen, behind a run of `run` (1 to 5) equal ones. Bits that go
/// on as the run are best: the sooner a stuff bit comes, the more can follow, one before each fourth.
[[nodiscard]] constexpr unsigned most_stuff_bits(unsigned run, unsigned count) noexcept {
  const unsigned until_five = 5 - run;
  return count <= until_five ? 0 : 1 + (count - until_five - 1) / 4;
}

/// The most stuff bits among bits of which some can be chosen: the greatest number for each run that the last
/// bits can be.
class FdMostStuffed {
 public:
  constexpr void add(bool bit) noexcept {
    Ways next = none();
    go(bit, next);
    ways_ = next;
  }
  constexpr void add_any(unsigned count) noexcept {
    while (count-- > 0) {
      Ways next = none();
      go(false, next);
      go(true, next);
      ways_ = next;
    }
  }
  [[nodiscard]] constexpr unsigned most() const noexcept {
    int greatest = 0;
    for (const auto& level : ways_)
      for (const int stuffed : level) greatest = std::max(greatest, stuffed);
    return static_cast<unsigned>(greatest);
  }

 private:
  /// By level and length of the run, 1 to 5; below 0: it cannot be.
  using Ways = std::array<std::array<int, 6>, 2>;
  static constexpr Ways none() noexcept { return {{{-1, -1, -1, -1, -1, -1}, {-1, -1, -1, -1, -1, -1}}}; }

  constexpr void go(bool bit, Ways& next) const noexcept {
    for (unsigned level = 0; level < 2; ++level)
      for (unsigned run = 0; run <= 5; ++run) {
        if (ways_[level][run] < 0) continue;
        const bool stuffed = run == 5;
        const unsigned before = stuffed ? 1 - level : level;
        const unsigned length = before != (bit ? 1U : 0U) ? 1 : stuffed ? 2 : run + 1;
        int& way = next[bit ? 1 : 0][length];
        way = std::max(way, ways_[level][run] + (stuffed ? 1 : 0));
      }
  }

  Ways ways_{{{-1, -1, -1, -1, -1, -1}, {0, -1, -1, -1, -1, -1}}};  // SOF begins a run of its own
};

/// From ESI to the CRC delimiter, behind a bit BRS of `switches`. ESI is of either level.
[[nodiscard]] constexpr unsigned fd_worst_data_bits(unsigned length, bool switches) noexcept {
  unsigned most = 0;
  for (const bool passive : {false, true}) {
    // Behind FDF: res 0, BRS, ESI, DLC.
    unsigned run = 0;
    unsigned stuffed = 0;
    bool last = true;
    const auto add = [&](bool bit) {
      if (run == 5) {
        ++stuffed;
        last = !last;
        run = 1;
      }
      run = bit == last ? run + 1 : 1;
      last = bit;
    };
    add(false);
    add(switches);
    add(passive);
    for (unsigned i = 4; i-- > 0;) add((fd_dlc(length) >> i & 1) != 0);
    most = std::max(most, stuffed + most_stuff_bits(run, 8 * length));
  }
  return 1 + 4 + 8 * length + most + fd_crc_field_bits(length) + 1;
}

/// `header`: from SOF to BRS with its stuff bits.
[[nodiscard]] constexpr FdBits fd_worst_of(unsigned header, unsigned length, bool switches) noexcept {
  const unsigned data = fd_worst_data_bits(length, switches);
  const unsigned last = trailer_bits - 1 + intermission_bits;
  return switches ? FdBits{header + last, data} : FdBits{header + data + last, 0};
}

}  // namespace detail

/// Of a data frame with this identifier and so many bytes, intermission included. `length` is one of CAN
/// FD's, the identifier one of its format.
[[nodiscard]] constexpr FdBits fd_worst_bits(std::uint32_t id, Format format, unsigned length,
                                             bool switches) noexcept {
  detail::FdBitCounter counter;
  counter.add(0, 1);  // SOF
  if (is_extended(format)) {
    counter.add(id >> 18, 11);
    counter.add(0b11, 2);  // SRR, IDE
    counter.add(id & 0x3'FFFF, 18);
    counter.add(0, 1);  // RRS
  } else {
    counter.add(id, 11);
    counter.add(0, 2);  // RRS, IDE
  }
  counter.add(0b10, 2);  // FDF, res
  counter.add(switches ? 1 : 0, 1);
  return detail::fd_worst_of(counter.bits(), length, switches);
}

/// Of any identifier: the most, which some identifier takes.
[[nodiscard]] constexpr FdBits fd_worst_bits(Format format, unsigned length, bool switches) noexcept {
  detail::FdMostStuffed header;
  header.add(false);  // SOF
  header.add_any(11);
  if (is_extended(format)) {
    header.add(true);  // SRR, IDE
    header.add(true);
    header.add_any(18);
    header.add(false);  // RRS
  } else {
    header.add(false);  // RRS, IDE
    header.add(false);
  }
  header.add(true);  // FDF
  header.add(false);
  header.add(switches);
  const unsigned plain = is_extended(format) ? 36 : 17;
  return detail::fd_worst_of(plain + header.most(), length, switches);
}

}  // namespace ocm::can
