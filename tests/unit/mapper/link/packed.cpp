#include "ocm/mapper/link/packed.hpp"

#include <algorithm>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include "unit/mapper/link/link_testing.hpp"

namespace mapper_link_packed_test {

using namespace ocm::mapper::link;
using ocm::base::Error;
using ocm::test::Random;

constexpr Update sample{-177, -61, -68, 49, 12, 30, 45, 80};

// Of another program (Python): sequence 0x05, x 0xFF4F, y 0xFFC3, heading 0xFFBC, servo 0x31, then 0x00C,
// 0x01E, 0x02D, 0x050; cut by seven: 0000010 1111111 1101001 1111111 1111110 0001111 1111111 0111100 0011000
// 1000000 0011000 0000001 1110000 0001011 0100000 1010000. The CRC, 0x1572, is of another program:
// binascii.crc_hqx of Python, from 0xFFFF.
constexpr std::array<std::uint8_t, max_packet> known{0xB1, 0x82, 0xFF, 0xE9, 0xFF, 0xFE, 0x8F,
                                                     0xFF, 0xBC, 0x98, 0xC0, 0x98, 0x81, 0xF0,
                                                     0x8B, 0xA0, 0xD0, 0x80, 0xAA, 0xF2};
static_assert(std::equal(known.begin(), known.end(), pack({5, sample})->data.begin()) &&
              pack({5, sample})->size == 20);
static_assert(unpack(std::span<const std::uint8_t, 20>{pack({5, sample})->data}).value ==
              PackedUpdate{5, sample});
static_assert(pack({0, Update{.servo = 91}}).error == Error::out_of_range);
static_assert(pack({0, Update{.heading = -361}}).error == Error::out_of_range);
static_assert(sizeof(PackedReader) <= 80);

std::vector<PackedUpdate> feed(PackedReader& reader, const Packet& packet) {
  std::vector<PackedUpdate> heard;
  for (const std::uint8_t byte : packet.bytes())
    if (reader.feed(byte)) heard.push_back(reader.packed());
  return heard;
}

TEST_CASE("packed: what is packed is unpacked equal, of bytes that no sentence has") {
  Random random{11};
  for (int n = 0; n < 5000; ++n) {
    const PackedUpdate sent{static_cast<std::uint8_t>(random.below(256)),
                            ocm::test::random_sentence<Update>(random)};
    const Packet packet = *pack(sent);
    REQUIRE(packet.size == max_packet);
    REQUIRE(std::all_of(packet.data.begin(), packet.data.end(), is_packed));
    REQUIRE(unpack(std::span<const std::uint8_t, 20>{packet.data}).value == sent);
  }
}

TEST_CASE("packed: no packet with up to three bits wrong is taken") {
  const Packet good = *pack({5, sample});
  const auto damaged = [&](std::size_t a, std::size_t b, std::size_t c) {
    auto data = good.data;
    for (const std::size_t bit : {a, b, c})
      data[bit / 8] = static_cast<std::uint8_t>(data[bit / 8] ^ 1U << bit % 8);
    return unpack(std::span<const std::uint8_t, 20>{data}).error == Error::bad_syntax;
  };
  int taken = 0;
  for (std::size_t a = 0; a < 160; ++a) {
    if (!damaged(a, a, a)) ++taken;  // three times the same: once
    for (std::size_t b = a + 1; b < 160; ++b) {
      // a alone and twice the last bit would be a again
      for (std::size_t c = b + 1; c < 160; ++c)
        if (!damaged(a, b, c)) ++taken;
    }
  }
  CHECK(taken == 0);
}

TEST_CASE("packed: cut off at any byte, the next one is heard, also without a pause between them") {
  for (std::size_t cut = 0; cut < max_packet; ++cut) {
    INFO(cut);
    PackedReader reader;
    Packet part = *pack({4, sample});
    part.size = static_cast<std::uint8_t>(cut);
    CHECK(feed(reader, part).empty());
    const auto direct = feed(reader, *pack({5, sample}));
    const auto next = feed(reader, *pack({6, sample}));
    REQUIRE(direct.size() + next.size() >= 1);
    CHECK(next.back() == PackedUpdate{6, sample});
    CHECK((reader.faults().total() > 0) == (cut > 0));

    PackedReader interrupted;
    (void)feed(interrupted, part);
    interrupted.interrupt();
    CHECK(interrupted.faults().torn == (cut > 0 ? 1 : 0));
    CHECK(feed(interrupted, *pack({5, sample})).size() == 1);
  }
}

TEST_CASE("packed: an update that begins within a torn one is heard, and what was before it is stray") {
  for (std::uint32_t cut = 1; cut <= 16; ++cut) {
    CAPTURE(cut);
    PackedReader reader;
    Packet part = *pack({4, sample});
    part.size = static_cast<std::uint8_t>(cut);
    CHECK(feed(reader, part).empty());
    CHECK(feed(reader, *pack({5, sample})) == std::vector{PackedUpdate{5, sample}});
    CHECK(reader.faults() == PackedFaults{.corrupt = 1, .stray = cut});
  }
}

TEST_CASE("packed: of a damaged update all bytes are stray, and so is each outside of any") {
  PackedReader reader;
  Packet damaged = *pack({5, sample});
  damaged.data[5] = static_cast<std::uint8_t>(damaged.data[5] ^ 1U);
  CHECK(feed(reader, damaged).empty());
  CHECK(reader.faults() == PackedFaults{.corrupt = 1, .stray = 20});
  CHECK_FALSE(reader.feed(0x80));
  CHECK_FALSE(reader.feed(0xFF));
  CHECK(reader.faults() == PackedFaults{.corrupt = 1, .stray = 22});
  CHECK(feed(reader, *pack({6, sample})).size() == 1);
  CHECK(reader.faults() == PackedFaults{.corrupt = 1, .stray = 22});
}

TEST_CASE("packed: what is lost, repeated or late is counted, and the number may wrap") {
  PackedReader reader;
  for (const int sequence : {200, 201, 201, 204, 202, 255, 0, 1, 1, 254})
    (void)feed(reader, *pack({static_cast<std::uint8_t>(sequence), sample}));
  CHECK(reader.heard() == 6);  // 200 201 204 255 0 1
  CHECK(reader.faults() == PackedFaults{.lost = 2 + 50, .repeated = 2, .late = 2});
  reader.restart();
  CHECK(feed(reader, *pack({7, sample})).size() == 1);
  CHECK(reader.faults().lost == 52);
  // Half of the numbers are ahead, half behind.
  CHECK(feed(reader, *pack({7 + 128, sample})).empty());
  CHECK(reader.faults().late == 3);
  CHECK(feed(reader, *pack({7 + 127, sample})).size() == 1);
  CHECK(reader.faults().lost == 52 + 126);
}

TEST_CASE("packed: of any loss nothing is heard that was not sent") {
  Random random{13};
  PackedReader reader;
  std::uint32_t lost = 0;
  std::uint32_t pending = 0;
  std::uint32_t heard = 0;
  for (int n = 0; n < 20'000; ++n) {
    const PackedUpdate sent{static_cast<std::uint8_t>(n & 0xFF), ocm::test::likely_update(random)};
    if (random.below(100) < 30) {
      pending += heard > 0 ? 1 : 0;
      continue;
    }
    const auto got = feed(reader, *pack(sent));
    REQUIRE(got.size() == 1);
    REQUIRE(got[0] == sent);
    lost += pending;
    pending = 0;
    ++heard;
  }
  CHECK(reader.faults() == PackedFaults{.lost = lost});
  CHECK(reader.heard() == heard);
}

TEST_CASE("packed: a whole packet with a field that cannot be is refused by that name") {
  Packet packet = *pack({5, sample});
  packet.data[9] = 0xFF;  // of the servo's eight bits
  const std::uint16_t crc = ocm::base::crc16(packet.bytes().first(17));
  packet.data[17] = static_cast<std::uint8_t>(0x80 | crc >> 14);
  packet.data[18] = static_cast<std::uint8_t>(0x80 | (crc >> 7 & 0x7F));
  packet.data[19] = static_cast<std::uint8_t>(0x80 | (crc & 0x7F));
  PackedReader reader;
  CHECK(feed(reader, packet).empty());
  CHECK(reader.faults() == PackedFaults{.out_of_range = 1});
}

}  // namespace mapper_link_packed_test
