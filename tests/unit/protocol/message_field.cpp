// Fields of generated messages, against the run-time codec: a position at a time, in frames of eight bytes
// and in longer ones, which a machine without registers of 64 bits handles byte by byte.
#include "ocm/protocol/message_field.hpp"

#include <limits>
#include <random>

#include <catch2/catch.hpp>

namespace protocol_message_field_test {

using namespace ocm;
using protocol::ByteOrder;
using protocol::MessageBytes;
using protocol::Position;
using protocol::read_field;
using protocol::write_field;
using protocol::write_nearest;

// B5 3A: read from the low end bits 4 to 15 are 3AB; from the high one bits 3 to 0 and 15 to 8 are 5 3A.
TEST_CASE("message fields: both byte orders") {
  constexpr MessageBytes<8> bytes{0xB5, 0x3A};
  STATIC_REQUIRE(read_field<std::uint16_t>(bytes, {4, 12}) == 0x3AB);
  STATIC_REQUIRE(read_field<std::uint16_t>(bytes, {3, 12, ByteOrder::big}) == 0x53A);
  constexpr MessageBytes<12> longer{0xB5, 0x3A};
  STATIC_REQUIRE(read_field<std::uint16_t>(longer, {4, 12}) == 0x3AB);
  STATIC_REQUIRE(read_field<std::uint16_t>(longer, {3, 12, ByteOrder::big}) == 0x53A);
  STATIC_REQUIRE(read_field<std::int16_t>(longer, {4, 11}) == 0x3AB);
  STATIC_REQUIRE(read_field<std::int16_t>(longer, {4, 10}) == 0x3AB - 0x400);
}

TEST_CASE("message fields: what the width does not hold is put as the nearest that it does") {
  const auto put = [](auto value, Position at) {
    MessageBytes<8> bytes{};
    write_field(bytes, at, value);
    return read_field<decltype(value)>(bytes, at);
  };
  CHECK(put(std::int16_t{2048}, {16, 12}) == 2047);
  CHECK(put(std::int16_t{-2049}, {16, 12}) == -2048);
  CHECK(put(std::uint8_t{9}, {3, 3}) == 7);
  CHECK(put(UINT64_MAX, {0, 64}) == UINT64_MAX);
  CHECK(put(INT64_MIN, {0, 64}) == INT64_MIN);
}

TEST_CASE("message fields: the raw number nearest to a value") {
  const auto put = [](auto zero, Position at, double value) {
    MessageBytes<8> bytes{};
    write_nearest<decltype(zero)>(bytes, at, value);
    return read_field<decltype(zero)>(bytes, at);
  };
  CHECK(put(std::uint8_t{}, {0, 4}, 7.5) == 8);
  CHECK(put(std::uint8_t{}, {0, 4}, 99) == 15);
  CHECK(put(std::int8_t{}, {0, 4}, -99) == -8);
  CHECK(put(std::int8_t{}, {0, 4}, std::numeric_limits<double>::quiet_NaN()) == 0);
  CHECK(put(std::uint64_t{}, {0, 64}, 1e19) == 10'000'000'000'000'000'000U);
}

/// Every position in so many bytes, with random bits: what it reads, what it puts, and that it puts nothing
/// beside it.
template <std::size_t Bytes, class T>
void check_all(std::mt19937_64& random) {
  for (const ByteOrder order : {ByteOrder::little, ByteOrder::big})
    for (unsigned width = 1; width <= 8 * sizeof(T); ++width)
      for (std::uint16_t start = 0; start < 8 * Bytes; ++start) {
        const Position at{start, static_cast<std::uint8_t>(width), order};
        if (at.bytes() > Bytes) continue;
        MessageBytes<Bytes> bytes{};
        for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
        const auto expected =
            static_cast<T>(protocol::get(std::span<const std::uint8_t>{bytes}, at, std::is_signed_v<T>));
        if (read_field<T>(bytes, at) != expected) {
          CAPTURE(start, width, static_cast<int>(order));
          CHECK(read_field<T>(bytes, at) == expected);
        }
        const auto value =
            static_cast<T>(protocol::get(std::span<const std::uint8_t>{bytes},
                                         {0, static_cast<std::uint8_t>(width)}, std::is_signed_v<T>));
        MessageBytes<Bytes> by_codec = bytes;
        protocol::put(std::span<std::uint8_t>{by_codec}, at, static_cast<std::int64_t>(value));
        write_field(bytes, at, value);
        if (bytes != by_codec) {
          CAPTURE(start, width, static_cast<int>(order));
          CHECK(bytes == by_codec);
        }
      }
}

TEST_CASE("message fields: every position and width as the run-time codec has it") {
  std::mt19937_64 random{5};
  check_all<8, std::uint8_t>(random);
  check_all<8, std::int16_t>(random);
  check_all<8, std::uint32_t>(random);
  check_all<8, std::int64_t>(random);
  check_all<12, std::int8_t>(random);
  check_all<12, std::uint16_t>(random);
  check_all<12, std::int32_t>(random);
  check_all<12, std::uint64_t>(random);
}

}  // namespace protocol_message_field_test
