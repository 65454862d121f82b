#include "ocm/can/fd_worst_bits.hpp"

#include <algorithm>
#include <array>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"
#include "unit/can/longest_fd.hpp"

namespace can_fd_worst_bits_test {

using namespace ocm;
using can::AnyFrame;
using can::FdBits;
using can::Format;

// By hand. SOF, 11, RRS, IDE, FDF, res, BRS are 17 bits; behind them ACK, its delimiter, 7 of EOF, 3 of
// intermission: 12. Identifier 00001111000: SOF makes five zeros of the first four, a stuff bit 1 five ones
// of the next four, a stuff bit 0 and RRS five zeros of the last three, with a third stuff bit before IDE.
static_assert(can::fd_worst_bits(0b00001111000, Format::base, 0, true).nominal == 17 + 3 + 12);
static_assert(can::fd_worst_bits(Format::base, 0, true).nominal == 17 + 3 + 12);
// No run of five: 10101010101.
static_assert(can::fd_worst_bits(0x555, Format::base, 0, true).nominal == 17 + 12);
// 36 bits with 29 of identifier. A stuff bit before the sixth and each fourth after it, to FDF, the 34th,
// would be 8; SRR, a one among the zeros of the third run, costs one of them.
static_assert(can::fd_worst_bits(Format::extended, 0, true).nominal == 36 + 7 + 12);

// Data. BRS 1, ESI, DLC: with no data nothing is stuffed behind BRS but 1 1 1111 (DLC 15), and 00000 of ESI
// and DLC 0 ends where the fixed stuff bits begin. ESI, DLC 4; stuff count 4, CRC 17, fixed 6; delimiter 1.
static_assert(can::fd_worst_bits(0x555, Format::base, 0, true).data == 5 + 27 + 1);
// DLC 8 = 1000: a run of three zeros. 64 bits: two more zeros, then a stuff bit before each fourth of the
// 62 that are left: 16.
static_assert(can::fd_worst_bits(0x555, Format::base, 8, true).data == 5 + 64 + 16 + 27 + 1);
// DLC 15 = 1111 behind BRS 1, ESI 1: six ones, a stuff bit (0) before the last, so 1 is the last, a run of
// one; four more, then 508 bits: 127. In all 128. With ESI 0: a run of four, one more, 511 bits: 128.
static_assert(can::fd_worst_bits(0x555, Format::base, 64, true).data == 5 + 512 + 128 + 32 + 1);
// One rate: the same bits in one number. DLC 1000 behind res 0, BRS 0, ESI 0: no run of five there.
static_assert(can::fd_worst_bits(0x555, Format::base, 8, false) == FdBits{17 + 5 + 64 + 16 + 27 + 1 + 12, 0});
// DLC 0000 behind 000: a stuff bit behind five, a run of two zeros.
static_assert(can::fd_worst_bits(0x555, Format::base, 0, false).nominal == 17 + 5 + 1 + 27 + 1 + 12);

AnyFrame frame_of(std::uint32_t id, Format format, unsigned length, bool switches, bool passive = false) {
  AnyFrame frame;
  frame.id = id;
  frame.format = format;
  frame.length = static_cast<std::uint8_t>(length);
  frame.flags = static_cast<std::uint8_t>(can::frame_flag::fd | (switches ? 1 : 0) | (passive ? 2 : 0));
  return frame;
}

FdBits with_intermission(FdBits bits) {
  return {bits.nominal + can::intermission_bits, bits.data};
}

TEST_CASE("CAN FD: each identifier of 11 bits, and the two bytes of each content, counted bit by bit") {
  for (const bool switches : {false, true}) {
    unsigned any_nominal = 0;
    for (std::uint32_t id = 0; id <= can::max_base_id; ++id) {
      const FdBits counted = with_intermission(can::fd_frame_bits(frame_of(id, Format::base, 0, switches)));
      const FdBits passive =
          with_intermission(can::fd_frame_bits(frame_of(id, Format::base, 0, switches, true)));
      const FdBits said = can::fd_worst_bits(id, Format::base, 0, switches);
      REQUIRE(said.nominal == std::max(counted.nominal, passive.nominal));
      REQUIRE(said.data == std::max(counted.data, passive.data));
      any_nominal = std::max(any_nominal, said.nominal);
    }
    REQUIRE(can::fd_worst_bits(Format::base, 0, switches).nominal == any_nominal);
    for (const std::uint32_t id : {0U, 0x0F8U, 0x7FFU, 0x555U})
      for (const unsigned length : {1U, 2U}) {
        FdBits longest{};
        for (std::uint32_t content = 0; content < std::uint32_t{1} << 8 * length; ++content)
          for (const bool passive : {false, true}) {
            AnyFrame frame = frame_of(id, Format::base, length, switches, passive);
            for (unsigned i = 0; i < length; ++i) frame.data[i] = static_cast<std::uint8_t>(content >> 8 * i);
            const FdBits bits = with_intermission(can::fd_frame_bits(frame));
            longest = {std::max(longest.nominal, bits.nominal), std::max(longest.data, bits.data)};
          }
        REQUIRE(can::fd_worst_bits(id, Format::base, length, switches) == longest);
      }
  }
}

/// The runs that a header can have behind IDE, with the most stuff bits, from every first part; then every
/// second part behind each of them.
TEST_CASE("CAN FD: all identifiers of 29 bits, the first 11 and the last 18 one behind the other") {
  struct Walk {
    unsigned run = 0;
    unsigned stuffed = 0;
    bool last = true;
    void add(std::uint32_t value, unsigned width) {
      while (width-- > 0) {
        const bool bit = (value >> width & 1) != 0;
        if (run == 5) {
          ++stuffed;
          last = !last;
          run = 1;
        }
        run = bit == last ? run + 1 : 1;
        last = bit;
      }
    }
  };
  std::array<int, 6> behind_ide{-1, -1, -1, -1, -1, -1};  // of ones: SRR and IDE are
  for (std::uint32_t high = 0; high < 0x800; ++high) {
    Walk walk;
    walk.add(0, 1);
    walk.add(high, 11);
    walk.add(3, 2);
    REQUIRE(walk.last);
    behind_ide.at(walk.run) = std::max(behind_ide.at(walk.run), static_cast<int>(walk.stuffed));
  }
  unsigned most = 0;
  for (unsigned run = 1; run <= 5; ++run) {
    if (behind_ide.at(run) < 0) continue;
    for (std::uint32_t low = 0; low < std::uint32_t{1} << 18; ++low) {
      Walk walk{run, static_cast<unsigned>(behind_ide.at(run)), true};
      walk.add(low, 18);
      walk.add(0b010, 3);  // RRS, FDF, res
      most = std::max(most, walk.stuffed);
    }
  }
  CHECK(can::fd_worst_bits(Format::extended, 0, true).nominal == 36 + most + 12);
}

TEST_CASE("CAN FD: nothing is longer than was said, and some content is as long") {
  ocm::test::Random random{64};
  unsigned reached = 0;
  unsigned looked_for = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Format format = random.below(2) == 0 ? Format::extended : Format::base;
    const std::uint32_t id = random.below(format == Format::extended ? can::max_extended_id + 1 : 0x800U);
    const unsigned length = can::fd_length(random.below(16));
    const bool switches = random.below(2) == 0;
    AnyFrame frame = frame_of(id, format, length, switches, random.below(2) == 0);
    const std::uint32_t kind = random.below(4);
    constexpr std::array<std::uint8_t, 6> runs{0x0F, 0xF0, 0x87, 0x78, 0xE1, 0x1E};
    const std::uint8_t run = runs.at(random.below(6));
    for (std::size_t k = 0; k < length; ++k)
      frame.data[k] = static_cast<std::uint8_t>(kind == 0   ? run
                                                : kind == 1 ? 0
                                                : kind == 2 ? 0xFF
                                                            : random.below(256));
    const FdBits said = can::fd_worst_bits(id, format, length, switches);
    const FdBits any = can::fd_worst_bits(format, length, switches);
    const FdBits counted = with_intermission(can::fd_frame_bits(frame));
    REQUIRE(counted.nominal <= said.nominal);
    REQUIRE(counted.data <= said.data);
    REQUIRE(said.nominal <= any.nominal);
    REQUIRE(said.data == any.data);
    if (i % 50 != 0) continue;
    ++looked_for;
    FdBits longest{};
    for (const bool passive : {false, true}) {
      const FdBits bits = with_intermission(
          can::fd_frame_bits(test::with_longest_data(frame_of(id, format, length, switches, passive))));
      longest = {std::max(longest.nominal, bits.nominal), std::max(longest.data, bits.data)};
    }
    reached += longest == said ? 1 : 0;
  }
  CHECK(reached == looked_for);
}

}  // namespace can_fd_worst_bits_test
