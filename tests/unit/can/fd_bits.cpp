#include "ocm/can/fd_bits.hpp"

#include <bitset>
#include <string>
#include <utility>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"

namespace can_fd_bits_test {

using namespace ocm;
using can::AnyFrame;
using can::FdBits;
using can::Format;

constexpr AnyFrame fd(std::uint32_t id, std::uint8_t length, std::uint8_t fill, Format format = Format::base,
                      std::uint8_t flags = can::frame_flag::bit_rate_switch) {
  AnyFrame frame;
  frame.id = id;
  frame.format = format;
  frame.length = length;
  frame.flags = static_cast<std::uint8_t>(flags | can::frame_flag::fd);
  for (std::size_t i = 0; i < length; ++i) frame.data[i] = fill;
  return frame;
}

static_assert(FdBits{} == FdBits{0, 0});

// By hand, bit by bit. [ISO 11898-1:2015, figures of the FD frame formats]

// SOF 0, identifier 10101010101, RRS 0, IDE 0, FDF 1, res 0, BRS 1: 17 bits, none stuffed. ACK, its delimiter
// and EOF: 9. ESI 0 and DLC 0000 are five equal bits at the end of what is stuffed: the fixed stuff bit is
// behind them, and no other one. Stuff count 4, CRC 17, fixed stuff bits 6, delimiter 1.
static_assert(can::fd_frame_bits(fd(0x555, 0, 0)) == FdBits{17 + 9, 5 + 4 + 17 + 6 + 1});
// DLC 0001 and the data 01010101: no five equal bits.
static_assert(can::fd_frame_bits(fd(0x555, 1, 0x55)) == FdBits{26, 5 + 8 + 28});
// Without a switch res, BRS, ESI and DLC are seven dominant bits, with one stuff bit among them; one rate.
static_assert(can::fd_frame_bits(fd(0x555, 0, 0, Format::base, 0)) == FdBits{17 + 5 + 1 + 28 + 9, 0});
// BRS, ESI and the first three bits of DLC 1111 are five recessive bits: a stuff bit at the rate of the data.
static_assert(can::fd_frame_bits(fd(0x555, 64, 0x55, Format::base, 3)) ==
              FdBits{26, 5 + 1 + 512 + 4 + 21 + 7 + 1});
// 512 dominant bits behind DLC 1111: a stuff bit behind each five of them but the last two.
static_assert(can::fd_frame_bits(fd(0x555, 64, 0)) == FdBits{26, 5 + 512 + 102 + 32 + 1});
// Up to 16 bytes have a CRC of 17 bits, and more have 21.
static_assert(can::fd_crc_field_bits(0) == 27 && can::fd_crc_field_bits(16) == 27 &&
              can::fd_crc_field_bits(20) == 32 && can::fd_crc_field_bits(64) == 32);
// SOF and 11 bits of identifier are 12 dominant bits: 2 stuff bits. SRR 1, IDE 1. 18 more and RRS are 19: 3
// stuff bits. FDF 1, res 0, BRS 1.
static_assert(can::fd_frame_bits(fd(0, 0, 0, Format::extended)) == FdBits{36 + 5 + 9, 33});

/// The same from a text of bits.
FdBits by_text(const AnyFrame& frame) {
  const auto bits = [](std::uint32_t value, std::size_t width) {
    return std::bitset<32>(value).to_string().substr(32 - width);
  };
  const bool switches = (frame.flags & can::frame_flag::bit_rate_switch) != 0;
  std::string header = "0";
  header += frame.format == Format::extended
                ? bits(frame.id >> 18, 11) + "11" + bits(frame.id & 0x3FFFF, 18) + "0"
                : bits(frame.id, 11) + "00";
  header += switches ? "101" : "100";
  std::string rest = (frame.flags & can::frame_flag::error_state) != 0 ? "1" : "0";
  std::uint32_t code = frame.length;
  for (const auto& [dlc, length] :
       {std::pair{9U, 12}, {10, 16}, {11, 20}, {12, 24}, {13, 32}, {14, 48}, {15, 64}})
    if (frame.length == length) code = dlc;
  rest += bits(code, 4);
  for (std::size_t i = 0; i < frame.length; ++i) rest += bits(frame.data[i], 8);
  const std::string all = header + rest;
  std::string run;
  unsigned at_rate[2] = {};
  for (std::size_t i = 0; i < all.size(); ++i) {
    unsigned& count = at_rate[switches && i >= header.size() ? 1 : 0];
    if (run == "00000" || run == "11111") {
      run = run[0] == '0' ? "1" : "0";
      ++count;
    }
    run = !run.empty() && run.back() == all[i] ? run + all[i] : std::string(1, all[i]);
    ++count;
  }
  at_rate[switches ? 1 : 0] += (frame.length <= 16 ? 4 + 17 + 6 : 4 + 21 + 7) + 1;
  at_rate[0] += 9;
  return {at_rate[0], at_rate[1]};
}

TEST_CASE("random CAN FD frames take the bits that a text of them has") {
  ocm::test::Random random{11898};
  for (int i = 0; i < 20'000; ++i) {
    const Format format = random.below(2) == 0 ? Format::extended : Format::base;
    AnyFrame frame =
        fd(random.below(format == Format::extended ? can::max_extended_id + 1 : 0x800U),
           can::fd_length(random.below(16)), 0, format, static_cast<std::uint8_t>(random.below(4)));
    // Long runs of equal bits are rare in random data.
    const std::uint32_t kind = random.below(4);
    for (std::size_t k = 0; k < frame.length; ++k)
      frame.data[k] = static_cast<std::uint8_t>(kind == 0   ? 0
                                                : kind == 1 ? 0xFF
                                                            : random.below(256) & random.below(256));
    if (random.below(3) == 0) frame.id &= 0xFF;
    REQUIRE(can::fd_frame_bits(frame) == by_text(frame));
  }
}

}  // namespace can_fd_bits_test
