#include "ocm/protocol/codec.hpp"

#include <array>
#include <span>
#include <vector>

#include <catch2/catch.hpp>

#include "unit/protocol/codec_sweep.hpp"

namespace protocol_codec_test {

using ocm::can::Payload;
using ocm::protocol::Bits;
using ocm::protocol::ByteOrder;
using ocm::protocol::get;
using ocm::protocol::highest;
using ocm::protocol::lowest;
using ocm::protocol::Position;
using ocm::protocol::put;
using ocm::test::Random;

template <class Field, class T>
constexpr Payload with(T value, Payload data = {}) {
  Field::put(data, value);
  return data;
}

// --- vectors, worked out by hand ---

// A field that is derived of others has no place: no bits, no bytes.
static_assert(Position{}.mask() == 0 && Position{}.bytes() == 0);

// Two fields of 12 bits in three bytes, as DBC numbers them.
static_assert(with<Bits<std::uint16_t, 0, 12>>(std::uint16_t{0xABC}) == Payload{0xBC, 0x0A});
static_assert(with<Bits<std::uint16_t, 12, 12>>(std::uint16_t{0xABC}) == Payload{0x00, 0xC0, 0xAB});
static_assert(with<Bits<std::uint16_t, 7, 12, ByteOrder::big>>(std::uint16_t{0xABC}) == Payload{0xAB, 0xC0});
static_assert(with<Bits<std::uint16_t, 11, 12, ByteOrder::big>>(std::uint16_t{0xABC}) ==
              Payload{0x00, 0x0A, 0xBC});

// Odometry's 24 bits: -1 and the lowest. [AMiRo-OS 1.0]
static_assert(with<Bits<std::int32_t, 24, 24>>(-1) == Payload{0, 0, 0, 0xFF, 0xFF, 0xFF});
static_assert(with<Bits<std::int32_t, 0, 24>>(-8'388'608) == Payload{0x00, 0x00, 0x80});
static_assert(Bits<std::int32_t, 0, 24>::get({0xFF, 0xFF, 0xFF}) == -1);
static_assert(Bits<std::int32_t, 0, 24>::get({0xFF, 0xFF, 0x7F}) == 8'388'607);

// What the thesis's demo printed unsigned: power 64606 is -930 mW, gyroscope 65532 is -4 digits.
static_assert(Bits<std::int16_t, 32>::get({0, 0, 0, 0, 0x5E, 0xFC}) == -930);
static_assert(Bits<std::int16_t, 0>::get({0xFC, 0xFF}) == -4);
static_assert(get({0, 0, 0, 0, 0x5E, 0xFC}, {32, 16, ByteOrder::little}, true) == -930);
static_assert(get({0, 0, 0, 0, 0x5E, 0xFC}, {32, 16, ByteOrder::little}, false) == 64606);

// Big-endian words.
static_assert(with<Bits<std::uint32_t, 7, 32, ByteOrder::big>>(0x11223344U) ==
              Payload{0x11, 0x22, 0x33, 0x44});
static_assert(with<Bits<std::uint64_t, 7, 64, ByteOrder::big>>(std::uint64_t{0x1122334455667788}) ==
              Payload{0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88});
static_assert(with<Bits<std::uint64_t, 0, 64>>(std::uint64_t{0x1122334455667788}) ==
              Payload{0x88, 0x77, 0x66, 0x55, 0x44, 0x33, 0x22, 0x11});

// One bit, in the middle of others.
static_assert(with<Bits<std::uint8_t, 10, 1>>(std::uint8_t{1}) == Payload{0x00, 0x04});
static_assert(with<Bits<std::uint8_t, 10, 1>>(std::uint8_t{0}, {0xFF, 0xFF, 0xFF}) ==
              Payload{0xFF, 0xFB, 0xFF});
static_assert(Bits<std::int8_t, 10, 1>::get({0x00, 0x04}) == -1);

// --- positions ---

TEST_CASE("a position's mask are its bits, or nothing when it does not fit") {
  for (int start = 0; start < 600; ++start)
    for (int width = 0; width < 256; ++width)
      for (const auto order : {ByteOrder::little, ByteOrder::big}) {
        const Position p{static_cast<std::uint16_t>(start), static_cast<std::uint8_t>(width), order};
        std::uint64_t expected = 0;
        bool fits = width >= 1 && width <= 64 && start <= 63;
        for (int i = 0; fits && i < width; ++i) {
          const int bit = ocm::test::frame_bit(p, i);
          if (bit < 0)
            fits = false;
          else
            expected |= std::uint64_t{1} << bit;
        }
        INFO("start " << start << ", width " << width);
        REQUIRE(p.mask() == (fits ? expected : 0));
      }
}

TEST_CASE("bounds of widths") {
  STATIC_REQUIRE(lowest(1, false) == 0);
  STATIC_REQUIRE(highest(1, false) == 1);
  STATIC_REQUIRE(lowest(1, true) == -1);
  STATIC_REQUIRE(highest(1, true) == 0);
  STATIC_REQUIRE(lowest(12, true) == -2048);
  STATIC_REQUIRE(highest(12, true) == 2047);
  STATIC_REQUIRE(highest(12, false) == 4095);
  STATIC_REQUIRE(highest(63, false) == INT64_MAX);
  STATIC_REQUIRE(highest(64, false) == INT64_MAX);  // the run-time form's limit
  STATIC_REQUIRE(lowest(63, true) == INT64_MIN / 2);
  STATIC_REQUIRE(lowest(64, true) == INT64_MIN);
  STATIC_REQUIRE(highest(64, true) == INT64_MAX);
  STATIC_REQUIRE(Bits<std::uint64_t, 0, 64>::max == UINT64_MAX);
  STATIC_REQUIRE(Bits<std::int32_t, 0>::min == INT32_MIN);
  STATIC_REQUIRE(Bits<std::uint8_t, 0>::max == 255);
}

// --- saturation ---

TEST_CASE("a value that a width does not hold is put as the nearest one") {
  using Signed24 = Bits<std::int32_t, 0, 24>;
  STATIC_REQUIRE(Signed24::get(with<Signed24>(8'388'608)) == 8'388'607);
  STATIC_REQUIRE(Signed24::get(with<Signed24>(INT32_MAX)) == 8'388'607);
  STATIC_REQUIRE(Signed24::get(with<Signed24>(-8'388'609)) == -8'388'608);
  STATIC_REQUIRE(Signed24::get(with<Signed24>(INT32_MIN)) == -8'388'608);
  using Unsigned12 = Bits<std::uint16_t, 11, 12, ByteOrder::big>;
  STATIC_REQUIRE(Unsigned12::get(with<Unsigned12>(std::uint16_t{4096})) == 4095);
  STATIC_REQUIRE(Unsigned12::get(with<Unsigned12>(std::uint16_t{65535})) == 4095);
  using Unsigned63 = Bits<std::uint64_t, 0, 63>;
  STATIC_REQUIRE(Unsigned63::get(with<Unsigned63>(UINT64_MAX)) == UINT64_MAX / 2);
  using Signed1 = Bits<std::int8_t, 63, 1>;
  STATIC_REQUIRE(Signed1::get(with<Signed1>(std::int8_t{127})) == 0);
  STATIC_REQUIRE(Signed1::get(with<Signed1>(std::int8_t{-128})) == -1);
}

TEST_CASE("saturation leaves the neighbours alone") {
  constexpr Payload ones{0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF};
  STATIC_REQUIRE(with<Bits<std::int32_t, 4, 20>>(INT32_MIN, ones) ==
                 Payload{0x0F, 0x00, 0x80, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF});
  STATIC_REQUIRE(with<Bits<std::int32_t, 4, 20>>(INT32_MAX) == Payload{0xF0, 0xFF, 0x7F});
}

TEST_CASE("the run-time form puts the lowest bits: its caller has checked the range") {
  Payload data{};
  put(data, {4, 4, ByteOrder::little}, 0x1A);
  CHECK(data == Payload{0xA0});
  put(data, {4, 4, ByteOrder::little}, -1);
  CHECK(data == Payload{0xF0});
}

// --- types that are wider than the field ---

TEST_CASE("a type may be wider than the field needs") {
  STATIC_REQUIRE(Bits<std::int64_t, 0, 32>::get({0xFF, 0xFF, 0xFF, 0xFF}) == -1);
  STATIC_REQUIRE(Bits<std::int64_t, 0, 12>::get({0xFF, 0xFF}) == -1);
  STATIC_REQUIRE(Bits<std::int64_t, 0, 40>::get({0, 0, 0, 0, 0x80}) == -(std::int64_t{1} << 39));
  STATIC_REQUIRE(Bits<std::uint64_t, 0, 32>::get({0xFF, 0xFF, 0xFF, 0xFF}) == 0xFFFF'FFFF);
  STATIC_REQUIRE(Bits<std::int32_t, 0, 8>::get({0x80}) == -128);
  STATIC_REQUIRE(with<Bits<std::int64_t, 0, 32>>(std::int64_t{1} << 40) == Payload{0xFF, 0xFF, 0xFF, 0x7F});
  STATIC_REQUIRE(with<Bits<std::int64_t, 0, 32>>(std::int64_t{-1} << 40) == Payload{0x00, 0x00, 0x00, 0x80});
}

// --- the run-time form at every position ---

TEST_CASE("the run-time form agrees with bit after bit, everywhere") {
  Random random{1};
  int positions = 0;
  for (int start = 0; start < 64; ++start)
    for (int width = 1; width <= 64; ++width)
      for (const auto order : {ByteOrder::little, ByteOrder::big}) {
        const Position p{static_cast<std::uint16_t>(start), static_cast<std::uint8_t>(width), order};
        if (p.mask() == 0) continue;
        ++positions;
        for (int round = 0; round < 4; ++round) {
          const Payload before = ocm::test::random_payload(random);
          const std::uint64_t value = random.word();
          Payload data = before;
          put(data, p, static_cast<std::int64_t>(value));
          const Payload expected = ocm::test::put_by_bits(before, p, value);
          INFO("start " << start << ", width " << width << (order == ByteOrder::big ? ", big" : ", little"));
          REQUIRE(data == expected);
          for (const bool is_signed : {false, true})
            REQUIRE(static_cast<std::uint64_t>(get(data, p, is_signed)) ==
                    ocm::test::get_by_bits(expected, p, is_signed));
        }
      }
  CHECK(positions == 2 * 64 * 65 / 2);
}

// --- frames of any length ---

// A decoder of CAN databases shows -806 and -1075 for these. [DBC: `12|12@1-` and `35|12@0-` in 00 A0 CD 00
// 0B CD 00 00]
constexpr std::array<std::uint8_t, 8> two_signals{0x00, 0xA0, 0xCD, 0x00, 0x0B, 0xCD, 0x00, 0x00};
static_assert(get(std::span{two_signals}, {12, 12, ByteOrder::little}, true) == -806);
static_assert(get(std::span{two_signals}, {35, 12, ByteOrder::big}, true) == -1075);
static_assert(get(two_signals, {12, 12, ByteOrder::little}, true) == -806);
static_assert(get(two_signals, {35, 12, ByteOrder::big}, true) == -1075);

// As short as they may be: the compiler refuses to look beyond their ends.
constexpr std::array<std::uint8_t, 3> up_to_little{0x00, 0xA0, 0xCD};
constexpr std::array<std::uint8_t, 6> up_to_big{0x00, 0x00, 0x00, 0x00, 0x0B, 0xCD};
static_assert(get(std::span{up_to_little}, {12, 12, ByteOrder::little}, true) == -806);
static_assert(get(std::span{up_to_big}, {35, 12, ByteOrder::big}, true) == -1075);
template <std::size_t Bytes>
constexpr std::array<std::uint8_t, Bytes> put_into(Position position, std::int64_t value) {
  std::array<std::uint8_t, Bytes> data{};
  put(std::span{data}, position, value);
  return data;
}
static_assert(put_into<3>({12, 12, ByteOrder::little}, -806) == up_to_little);
static_assert(put_into<6>({35, 12, ByteOrder::big}, -1075) == up_to_big);

static_assert(Position{0, 8, ByteOrder::little}.bytes() == 1);
static_assert(Position{1, 8, ByteOrder::little}.bytes() == 2);
static_assert(Position{7, 8, ByteOrder::big}.bytes() == 1);
static_assert(Position{6, 8, ByteOrder::big}.bytes() == 2);
static_assert(Position{511, 8, ByteOrder::big}.bytes() == 64);
static_assert(Position{448, 64, ByteOrder::little}.bytes() == 64);

TEST_CASE("a field of a longer frame agrees with bit after bit, wherever it is") {
  Random random{2};
  int positions = 0;
  for (int start = 0; start < 512; ++start)
    for (int width = 1; width <= 64; width += 1 + start % 3)
      for (const auto order : {ByteOrder::little, ByteOrder::big}) {
        const Position p{static_cast<std::uint16_t>(start), static_cast<std::uint8_t>(width), order};
        const bool fits = ocm::test::frame_bit(p, order == ByteOrder::little ? width - 1 : 0, 64) >= 0;
        INFO("start " << start << ", width " << width << (order == ByteOrder::big ? ", big" : ", little"));
        REQUIRE((p.bytes() <= 64) == fits);
        if (!fits) continue;
        ++positions;
        std::vector<std::uint8_t> before(p.bytes());  // as short as it may be, for sanitizers to see
        for (auto& byte : before) byte = static_cast<std::uint8_t>(random.word());
        const std::uint64_t value = random.word();
        auto data = before;
        put(std::span{data}, p, static_cast<std::int64_t>(value));
        REQUIRE(data == ocm::test::put_by_bits(before, p, value));
        for (const bool is_signed : {false, true})
          REQUIRE(static_cast<std::uint64_t>(get(std::span<const std::uint8_t>{data}, p, is_signed)) ==
                  ocm::test::get_by_bits(data, p, is_signed));
      }
  CHECK(positions > 20'000);
}

TEST_CASE("two fields overlap where they have a bit in common") {
  Random random{3};
  const auto any = [&random] {
    const bool big = random.word() % 2 != 0;
    return Position{static_cast<std::uint16_t>(random.word() % 64),
                    static_cast<std::uint8_t>(1 + random.word() % 20),
                    big ? ByteOrder::big : ByteOrder::little};
  };
  int overlapping = 0;
  for (int round = 0; round < 20'000; ++round) {
    const Position a = any();
    const Position b = any();
    if (a.mask() == 0 || b.mask() == 0) continue;
    const bool common = (a.mask() & b.mask()) != 0;
    INFO(a.start << "|" << int{a.width} << " " << b.start << "|" << int{b.width});
    REQUIRE(a.overlaps(b) == common);
    REQUIRE(b.overlaps(a) == common);
    overlapping += common ? 1 : 0;
  }
  CHECK(overlapping > 1000);
}

}  // namespace protocol_codec_test
