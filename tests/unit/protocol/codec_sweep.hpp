/// Every position there is, signed and unsigned, at compile time: the template form, the run-time form and a
/// model that moves one bit after the other must agree. One source file an order and half of the starts, or
/// the compiler takes too long.
#pragma once

#include <array>
#include <type_traits>
#include <utility>

#include <catch2/catch.hpp>

#include "ocm/protocol/codec.hpp"

#include "unit/base/random.hpp"

namespace ocm::test {

using can::Payload;
using protocol::ByteOrder;
using protocol::Position;

/// The frame's bit that holds bit `i` of the field, 0 the least significant: DBC's numbering, from its
/// definition by walking, not by arithmetic on masks. -1 where the frame ends.
inline int frame_bit(Position p, int i) {
  if (p.order == ByteOrder::little) return p.start + i <= 63 ? p.start + i : -1;
  int bit = p.start;  // the most significant
  for (int k = p.width - 1; k > i; --k) {
    if (bit % 8 != 0)
      --bit;
    else if (bit / 8 < 7)
      bit = 8 * (bit / 8 + 1) + 7;
    else
      return -1;
  }
  return bit;
}

inline bool bit_of(const Payload& data, int bit) {
  return (data[static_cast<std::size_t>(bit / 8)] >> (bit % 8) & 1) != 0;
}

inline Payload put_by_bits(Payload data, Position p, std::uint64_t value) {
  for (int i = 0; i < p.width; ++i) {
    const int bit = frame_bit(p, i);
    auto& byte = data[static_cast<std::size_t>(bit / 8)];
    byte = static_cast<std::uint8_t>((byte & ~(1U << bit % 8)) | (value >> i & 1) << bit % 8);
  }
  return data;
}

inline std::uint64_t get_by_bits(const Payload& data, Position p, bool is_signed) {
  std::uint64_t value = 0;
  for (int i = 63; i >= 0; --i) {
    const int from = i < p.width ? i : is_signed ? p.width - 1 : -1;
    value = value << 1 | (from >= 0 && bit_of(data, frame_bit(p, from)) ? 1 : 0);
  }
  return value;
}

inline Payload random_payload(Random& random) {
  Payload data{};
  const std::uint64_t word = random.word();
  for (unsigned i = 0; i < 8; ++i) data[i] = static_cast<std::uint8_t>(word >> 8 * i);
  return data;
}

/// What the sweep calls of one field, without its type: values travel as 64 bits, signed ones extended.
struct FieldUnderTest {
  Position position;
  bool is_signed;
  std::uint64_t (*get)(const Payload&);
  void (*put)(std::uint64_t value, Payload& data, Payload& by_word, Payload& by_bytes);
};

template <unsigned Width>
using Smallest =
    std::conditional_t<(Width <= 8), std::uint8_t,
                       std::conditional_t<(Width <= 16), std::uint16_t,
                                          std::conditional_t<(Width <= 32), std::uint32_t, std::uint64_t>>>;

template <class T, unsigned Start, unsigned Width, ByteOrder Order>
struct Thunks {
  using Bits = protocol::Bits<T, Start, Width, Order>;
  static std::uint64_t get(const Payload& data) { return static_cast<std::uint64_t>(Bits::get(data)); }
  static void put(std::uint64_t value, Payload& data, Payload& by_word, Payload& by_bytes) {
    Bits::put(data, static_cast<T>(value));
    Bits::put_by_word(by_word, static_cast<T>(value));
    Bits::put_by_bytes(by_bytes, static_cast<T>(value));
  }
  static constexpr FieldUnderTest field{Bits::position, std::is_signed_v<T>, get, put};
};

inline void check(const FieldUnderTest& field, Random& random) {
  const Position p = field.position;
  const std::uint64_t ones = ~std::uint64_t{0} >> (64 - p.width);
  const std::uint64_t top = std::uint64_t{1} << (p.width - 1);
  const std::uint64_t values[] = {0, 1, ones, top, top - 1, random.word(), random.word()};
  for (const std::uint64_t bits : values) {
    const Payload before = random_payload(random);
    const Payload expected = put_by_bits(before, p, bits);
    const std::uint64_t value = get_by_bits(expected, p, field.is_signed);

    Payload typed = before;
    Payload by_word = before;
    Payload by_bytes = before;
    Payload run_time = before;
    field.put(value, typed, by_word, by_bytes);
    protocol::put(run_time, p, static_cast<std::int64_t>(value));
    if (typed == expected && by_word == expected && by_bytes == expected && run_time == expected &&
        field.get(expected) == value &&
        static_cast<std::uint64_t>(protocol::get(expected, p, field.is_signed)) == value)
      continue;
    FAIL("start " << int{p.start} << ", width " << int{p.width}
                  << (p.order == ByteOrder::big ? ", big" : ", little")
                  << (field.is_signed ? ", signed" : ", unsigned") << ", value " << value);
  }
}

/// Unsigned at every position; signed where the field starts in the first byte, because the sign depends on
/// the width alone.
template <ByteOrder Order, unsigned Start, unsigned Width>
void check_position(Random& random, int& positions) {
  if constexpr (Position{Start, Width, Order}.mask() != 0) {
    ++positions;
    check(Thunks<Smallest<Width>, Start, Width, Order>::field, random);
    if constexpr (Start < 8)
      check(Thunks<std::make_signed_t<Smallest<Width>>, Start, Width, Order>::field, random);
  }
}

template <ByteOrder Order, unsigned Start, unsigned... Width>
void check_start(Random& random, int& positions, std::integer_sequence<unsigned, Width...>) {
  (check_position<Order, Start, Width + 1>(random, positions), ...);
}

/// All widths at starts First .. First + sizeof...(Start) - 1. Returns how many positions fit the frame.
template <ByteOrder Order, unsigned First, unsigned... Start>
int sweep(std::integer_sequence<unsigned, Start...>) {
  Random random{First};
  int positions = 0;
  (check_start<Order, First + Start>(random, positions, std::make_integer_sequence<unsigned, 64>{}), ...);
  return positions;
}

}  // namespace ocm::test
