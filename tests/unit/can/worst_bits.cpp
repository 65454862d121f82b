#include "ocm/can/worst_bits.hpp"

#include <algorithm>
#include <memory>
#include <random>

#include <catch2/catch.hpp>

#include "unit/base/explore.hpp"

namespace can_worst_bits_test {

using namespace ocm;
using can::Format;
using can::Frame;
using can::frame_bits;
using can::intermission_bits;

/// One for all test cases: it is 2.25 MiB.
const can::WorstBits& worst() {
  static const auto table = std::make_unique<const can::WorstBits>();
  return *table;
}

/// Every content, counted bit by bit.
unsigned longest_of_all(Frame frame) {
  const unsigned contents = 1U << 8 * frame.bytes().size();
  unsigned most = 0;
  for (unsigned content = 0; content < contents; ++content) {
    for (std::size_t i = 0; i < frame.bytes().size(); ++i)
      frame.data[i] = static_cast<std::uint8_t>(content >> 8 * i);
    most = std::max(most, frame_bits(frame));
  }
  return most + intermission_bits;
}

std::uint32_t greatest_id(Format format) {
  return can::is_extended(format) ? can::max_extended_id : can::max_base_id;
}

TEST_CASE("frames without data, remote frames and one byte of data: every base identifier, every content") {
  for (std::uint32_t id = 0; id <= can::max_base_id; ++id) {
    INFO("id " << id);
    REQUIRE(worst().bits(id, Format::base, 0) == longest_of_all({.id = id}));
    REQUIRE(worst().bits(id, Format::base, 1) == longest_of_all({.id = id, .dlc = 1}));
    for (std::uint8_t dlc = 0; dlc <= 8; ++dlc)
      REQUIRE(worst().bits(id, Format::base_remote, dlc) ==
              longest_of_all({.id = id, .dlc = dlc, .format = Format::base_remote}));
  }
}

TEST_CASE("two bytes of data: every content, of identifiers from both ends, in runs and at random") {
  std::mt19937 random{1991};
  for (const Format format : {Format::base, Format::extended})
    for (int i = 0; i < 40; ++i) {
      const std::uint32_t shape[] = {0, greatest_id(format), 0x78, static_cast<std::uint32_t>(random())};
      const std::uint32_t id = shape[std::min(i, 3)] & greatest_id(format);
      INFO("id " << id << (format == Format::extended ? " extended" : ""));
      REQUIRE(worst().bits(id, format, 2) == longest_of_all({.id = id, .dlc = 2, .format = format}));
    }
}

TEST_CASE("the witness is as long as was said, for every base identifier and length") {
  for (std::uint32_t id = 0; id <= can::max_base_id; id += 3)
    for (std::uint8_t dlc = 0; dlc <= 8; ++dlc) {
      const Frame frame = worst().witness(id, Format::base, dlc);
      INFO("id " << id << " dlc " << int{dlc});
      REQUIRE(frame.id == id);
      REQUIRE(frame.dlc == dlc);
      REQUIRE(frame_bits(frame) + intermission_bits == worst().bits(id, Format::base, dlc));
    }
}

TEST_CASE("nothing is longer than was said") {
  std::mt19937 random{15};
  const int frames = test::explored(100'000);
  for (int i = 0; i < frames; ++i) {
    Frame frame;
    frame.format = static_cast<Format>(random() % 4);
    frame.id = static_cast<std::uint32_t>(random()) & greatest_id(frame.format);
    frame.dlc = static_cast<std::uint8_t>(random() % 9);
    // Near the witness it is closest: two bits of it changed; or runs of four and five.
    if (!can::is_remote(frame.format)) {
      frame = worst().witness(frame.id, frame.format, frame.dlc);
      const bool runs = random() % 2 == 0;
      for (std::size_t k = 0; runs && k < frame.dlc; ++k)
        frame.data[k] = std::array<std::uint8_t, 6>{0x0F, 0xF0, 0x87, 0x78, 0xE1, 0x1E}[random() % 6];
      for (int flips = 0; flips < 2 && frame.dlc != 0; ++flips)
        frame.data[random() % frame.dlc] ^= static_cast<std::uint8_t>(1U << random() % 8);
    }
    const unsigned said = worst().bits(frame.id, frame.format, frame.dlc);
    INFO(frame.id << " dlc " << int{frame.dlc});
    REQUIRE(frame_bits(frame) + intermission_bits <= said);
    REQUIRE(said <= can::worst_frame_bits(frame.format, frame.dlc));
  }
}

// The same as by the forward search over all identifiers at once in length.cpp.
TEST_CASE("the longest base frame of eight bytes takes 133 bits, 2 below the closed bound; most take less") {
  unsigned most = 0;
  unsigned usual = 0;
  for (std::uint32_t id = 0; id <= can::max_base_id; ++id) {
    const unsigned bits = worst().bits(id, Format::base, 8);
    most = std::max(most, bits);
    usual += bits == 130 || bits == 131 ? 1 : 0;
  }
  CHECK(most == 133);
  CHECK(usual > 2048 / 2);
  CHECK(worst().bits(0x78, Format::base, 8) == 133);
}

TEST_CASE("of a parameter group: the longest of all sources and destinations, one by one") {
  for (const std::uint32_t id : {0x18EA'0000U, 0x0CF0'04FEU, 0x18FE'F1FEU}) {
    const std::uint32_t free = (id >> 16 & 0xFF) < 240 ? 0xFFFF : 0xFF;
    for (const std::uint8_t dlc : {std::uint8_t{3}, std::uint8_t{8}}) {
      unsigned most = 0;
      unsigned least = 1000;
      for (std::uint32_t other = id & ~free; other <= (id | free); ++other) {
        const unsigned bits = worst().bits(other, Format::extended, dlc);
        most = std::max(most, bits);
        least = std::min(least, bits);
      }
      CHECK(worst().bits_of_any(id, free, Format::extended, dlc) == most);
      CHECK(least < most);
    }
  }
  CHECK(worst().bits_of_any(0x123, 0, Format::base, 8) == worst().bits(0x123, Format::base, 8));
}

TEST_CASE("a frame that cannot exist has no length") {
  CHECK(worst().bits(0x800, Format::base, 0) == 0);
  CHECK(worst().bits(0x2000'0000, Format::extended, 0) == 0);
  CHECK(worst().bits(1, Format::base, 9) == 0);
  CHECK(worst().bits(1, Format::error, 8) == 0);
  CHECK(worst().witness(1, Format::base, 9).data == can::Payload{});
}

}  // namespace can_worst_bits_test
