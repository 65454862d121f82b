#include "ocm/can/length.hpp"

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "unit/base/explore.hpp"

namespace can_length_test {

using namespace ocm;
using can::Format;
using can::Frame;
using can::frame_bits;
using can::worst_frame_bits;

// By hand: 19 zeros from SOF to DLC, whose CRC is zero: 34 equal bits, a stuff bit after each full five of
// them.
static_assert(frame_bits({.id = 0, .dlc = 0}) == 34 + 6 + 10);

// What a frame has at least: 44 bits and the data, 64 for an extended one. [Bosch CAN 2.0, 3.1] In the first
// of these no five bits are equal, CRC included; all were written out by tests/sim/arbitration/schedule.py.
static_assert(frame_bits({.id = 0x555, .dlc = 5, .data = {0x55, 0x55, 0x55, 0x55, 0x55}}) == 44 + 40);
static_assert(frame_bits({.id = 0, .dlc = 8}) == 44 + 64 + 16);
static_assert(frame_bits({.id = 0x205, .dlc = 4, .data = {0x01, 0x84, 0x03, 0x02}}) == 44 + 32 + 5);
static_assert(frame_bits({.id = 0x123, .dlc = 8, .format = Format::base_remote}) == 44 + 1);
static_assert(frame_bits({.id = 0x1FFF'FFFF, .dlc = 0, .format = Format::extended_remote}) == 64 + 7);

// The bound. [Davis, Burns, Bril, Lukkien 2007: 55 + 10 s and 80 + 10 s; 135 bits for 8 bytes]
static_assert(worst_frame_bits(Format::base, 0) == 55);
static_assert(worst_frame_bits(Format::base, 8) == 135);
static_assert(worst_frame_bits(Format::extended, 0) == 80);
static_assert(worst_frame_bits(Format::extended, 8) == 160);
static_assert(worst_frame_bits(Format::base_remote, 8) == 55);

// No frame reaches it: the stuff bits of the header and the CRC cannot all fall. These are the longest that
// there are, found by dynamic programming over (CRC, run length) as in the test below.
static_assert(frame_bits({.id = 0x78, .dlc = 8, .data = {0x01, 0xE1, 0xE1, 0xE1, 0xE1, 0xE1, 0xE0, 0x0F}}) +
                  can::intermission_bits ==
              133);
static_assert(frame_bits({.id = 0x7C0, .dlc = 1, .data = {0x7D}}) + can::intermission_bits == 62);
static_assert(frame_bits({.id = 0xC3C3C,
                          .dlc = 8,
                          .data = {0x3C, 0x3C, 0x3F, 0xFF, 0x0F, 0x0F, 0x0F, 0x0F},
                          .format = Format::extended}) +
                  can::intermission_bits ==
              158);

std::string binary(std::uint32_t value, unsigned width) {
  std::string text;
  while (width-- > 0) text += (value >> width & 1) != 0 ? '1' : '0';
  return text;
}

/// Length by other means: the frame as text, the CRC as a division of polynomials, stuffing by building the
/// text.
unsigned length_by_text(const Frame& frame) {
  const std::string rtr = can::is_remote(frame.format) ? "1" : "0";
  std::string bits = "0";
  if (can::is_extended(frame.format))
    bits += binary(frame.id >> 18, 11) + "11" + binary(frame.id & 0x3'FFFF, 18) + rtr + "00";
  else
    bits += binary(frame.id, 11) + rtr + "00";
  bits += binary(frame.dlc, 4);
  if (!can::is_remote(frame.format))
    for (std::size_t i = 0; i < frame.dlc; ++i) bits += binary(frame.data[i], 8);

  const std::string polynomial = "1100010110011001";
  std::string rest = bits + std::string(15, '0');
  for (std::size_t i = 0; i < bits.size(); ++i)
    if (rest[i] == '1')
      for (std::size_t j = 0; j < polynomial.size(); ++j)
        rest[i + j] = rest[i + j] == polynomial[j] ? '0' : '1';
  bits += rest.substr(bits.size());

  std::string wire;
  for (const char bit : bits) {
    wire += bit;
    if (wire.size() < 5) continue;
    const std::string last = wire.substr(wire.size() - 5);
    if (last == "00000") wire += '1';
    if (last == "11111") wire += '0';
  }
  return static_cast<unsigned>(wire.size()) + 1 + 2 + 7;  // CRC delimiter, acknowledgement, end of frame
}

/// The most bits that a base data frame of this length can take, intermission included. Follows all
/// identifiers and data at once: for each CRC and each run of equal bits so far, the most stuff bits.
unsigned longest(unsigned data_bytes) {
  constexpr std::size_t states = (std::size_t{1} << 15) * 10;  // CRC, level, run of 1..4 (5 has been stuffed)
  std::string bits =
      "0" + std::string(11, '?') + "000" + binary(data_bytes, 4) + std::string(8 * data_bytes, '?');
  const auto after = [](std::size_t state, unsigned bit, bool in_crc, int& stuffed) {
    unsigned crc = static_cast<unsigned>(state / 10);
    unsigned level = static_cast<unsigned>(state % 10 / 5);
    unsigned run = static_cast<unsigned>(state % 5);
    run = bit == level ? run + 1 : 1;
    level = bit;
    if (run == 5) {
      ++stuffed;
      level = 1 - level;
      run = 1;
    }
    if (in_crc) {
      const bool feedback = (crc >> 14 & 1) != bit;
      crc = (crc << 1 & 0x7FFF) ^ (feedback ? can::crc15_polynomial : 0U);
    }
    return std::size_t{crc} * 10 + level * 5 + run;
  };
  std::vector<int> most(states, -1);
  most[1 * 5 + 0] = 0;
  for (const char bit : bits) {
    std::vector<int> next(states, -1);
    for (std::size_t state = 0; state < states; ++state)
      for (unsigned level = 0; most[state] >= 0 && level < 2; ++level) {
        if (bit != '?' && static_cast<unsigned>(bit - '0') != level) continue;
        int stuffed = most[state];
        const std::size_t reached = after(state, level, true, stuffed);
        next[reached] = std::max(next[reached], stuffed);
      }
    most.swap(next);
  }
  int best = 0;
  for (std::size_t begin = 0; begin < states; ++begin) {
    int stuffed = most[begin];
    if (stuffed < 0) continue;
    std::size_t state = begin;
    for (unsigned i = 15; i-- > 0;) state = after(state, begin / 10 >> i & 1, false, stuffed);
    best = std::max(best, stuffed);
  }
  return static_cast<unsigned>(bits.size()) + 15 + static_cast<unsigned>(best) + can::trailer_bits +
         can::intermission_bits;
}

TEST_CASE("the length of a frame equals that of its bits written out") {
  std::mt19937 random{11898};
  for (int i = 0; i < 20'000 / ocm::test::coarser(10); ++i) {
    Frame frame;
    frame.format = static_cast<Format>(random() % 4);
    frame.id = static_cast<std::uint32_t>(random()) &
               (can::is_extended(frame.format) ? can::max_extended_id : can::max_base_id);
    frame.dlc = static_cast<std::uint8_t>(random() % 9);
    // Long runs, so that there is much to stuff; a remote frame has a length and no data.
    for (std::size_t k = 0; k < frame.dlc && !can::is_remote(frame.format); ++k)
      frame.data[k] =
          static_cast<std::uint8_t>(std::array<std::uint_fast32_t, 4>{0, 0xFF, 0xF0, random()}[random() % 4]);
    INFO(frame.id << " dlc " << int{frame.dlc});
    REQUIRE(frame_bits(frame) == length_by_text(frame));
    REQUIRE(frame_bits(frame) + can::intermission_bits <= worst_frame_bits(frame.format, frame.dlc));
  }
}

TEST_CASE("no base frame is longer than 133 bits with its intermission, 2 below the bound") {
  if (!ocm::test::emulated) CHECK(longest(8) == 133);  // a count by the test alone
  CHECK(longest(1) == 62);
  CHECK(longest(0) == 53);
}

}  // namespace can_length_test
