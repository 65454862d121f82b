/// A model of a field that moves one bit after the other, and a sweep over every position there is.
#pragma once

#include <array>
#include <span>
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
inline int frame_bit(Position p, int i, int bytes = 8) {
  if (p.order == ByteOrder::little) return p.start + i < 8 * bytes ? p.start + i : -1;
  int bit = p.start;  // the most significant
  for (int k = p.width - 1; k > i; --k) {
    if (bit % 8 != 0)
      --bit;
    else if (bit / 8 < bytes - 1)
      bit = 8 * (bit / 8 + 1) + 7;
    else
      return -1;
  }
  return bit;
}

inline bool bit_of(std::span<const std::uint8_t> data, int bit) {
  return (data[static_cast<std::size_t>(bit / 8)] >> (bit % 8) & 1) != 0;
}

/// Of a frame of eight bytes, or of any length.
template <class Data>
Data put_by_bits(Data data, Position p, std::uint64_t value) {
  for (int i = 0; i < p.width; ++i) {
    const int bit = frame_bit(p, i, static_cast<int>(data.size()));
    auto& byte = data[static_cast<std::size_t>(bit / 8)];
    byte = static_cast<std::uint8_t>((byte & ~(1U << bit % 8)) | (value >> i & 1) << bit % 8);
  }
  return data;
}

inline std::uint64_t get_by_bits(std::span<const std::uint8_t> data, Position p, bool is_signed) {
  const int bytes = static_cast<int>(data.size());
  std::uint64_t value = 0;
  for (int i = 63; i >= 0; --i) {
    const int from = i < p.width ? i : is_signed ? p.width - 1 : -1;
    value = value << 1 | (from >= 0 && bit_of(data, frame_bit(p, from, bytes)) ? 1 : 0);
  }
  return value;
}

inline Payload random_payload(Random& random) {
  Payload data{};
  const std::uint64_t word = random.word();
  for (unsigned i = 0; i < 8; ++i) data[i] = static_cast<std::uint8_t>(word >> 8 * i);
  return data;
}

template <unsigned Width>
using Smallest =
    std::conditional_t<(Width <= 8), std::uint8_t,
                       std::conditional_t<(Width <= 16), std::uint16_t,
                                          std::conditional_t<(Width <= 32), std::uint32_t, std::uint64_t>>>;

/// Whether the template form does what the run-time form does, on a frame of other bits. Evaluated by the
/// compiler, which refuses undefined behaviour and makes no code of it.
template <class T, unsigned Start, unsigned Width, ByteOrder Order>
consteval bool agrees() {
  using Bits = protocol::Bits<T, Start, Width, Order>;
  constexpr Payload others{0x5A, 0xC3, 0x0F, 0x96, 0xA5, 0x3C, 0xF0, 0x69};
  for (const std::uint64_t value : {0x9E37'79B9'7F4A'7C15U, ~0x9E37'79B9'7F4A'7C15U}) {
    Payload expected = others;
    protocol::put(expected, Bits::position, static_cast<std::int64_t>(value));
    const T typed = Bits::get(expected);
    if (typed != static_cast<T>(protocol::get(expected, Bits::position, std::is_signed_v<T>))) return false;
    Payload by_word = others;
    Payload by_bytes = others;
    Bits::put_by_word(by_word, typed);
    Bits::put_by_bytes(by_bytes, typed);
    if (by_word != expected || by_bytes != expected) return false;
  }
  return true;
}

/// How many positions at this start fit the frame.
template <ByteOrder Order, unsigned Start, unsigned... Width>
consteval int sweep_widths(std::integer_sequence<unsigned, Width...>) {
  int positions = 0;
  const auto one = [&]<unsigned W>() {
    if constexpr (Position{Start, W, Order}.mask() != 0) {
      static_assert(agrees<Smallest<W>, Start, W, Order>());
      static_assert(agrees<std::make_signed_t<Smallest<W>>, Start, W, Order>());
      ++positions;
    }
  };
  (one.template operator()<Width + 1>(), ...);
  return positions;
}
template <ByteOrder Order, unsigned First, unsigned... Start>
consteval int sweep(std::integer_sequence<unsigned, Start...>) {
  return (sweep_widths<Order, First + Start>(std::make_integer_sequence<unsigned, 64>{}) + ...);
}

}  // namespace ocm::test
