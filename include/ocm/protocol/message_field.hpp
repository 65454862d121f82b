/// Fields of generated messages: from the message's bytes to a number of a type, and back. Positions are
/// known to the compiler where a generated accessor calls these, so that one load, a shift and a mask are
/// left; functions of the type alone keep a header with thousands of fields quick to compile.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "ocm/protocol/codec.hpp"
#include "ocm/protocol/physical.hpp"

namespace ocm::protocol {

/// A message's bytes. Eight where it has fewer: they are handled as one word.
template <std::size_t Bytes>
using MessageBytes = std::array<std::uint8_t, Bytes>;

/// The least and the greatest number of T in so many bits.
template <std::integral T>
[[gnu::always_inline]] [[nodiscard]] constexpr T lowest_of(unsigned width) noexcept {
  return static_cast<T>(lowest(width, std::is_signed_v<T>));
}
template <std::integral T>
[[gnu::always_inline]] [[nodiscard]] constexpr T highest_of(unsigned width) noexcept {
  if (!std::is_signed_v<T> && width >= 64) return static_cast<T>(~std::uint64_t{0});
  return static_cast<T>(highest(width, std::is_signed_v<T>));
}

namespace detail {

/// A field that lies in at most four bytes, as a machine without registers of 64 bits handles it: its bytes
/// one by one, no loop, so that with a position that is known nothing is left of all the cases.
struct ShortField {
  unsigned bytes = 0;  ///< how many it touches
  unsigned low = 0;    ///< the byte with its lowest bits
  int step = 1;        ///< from there to the next higher
  unsigned shift = 0;  ///< of its lowest bit within `low`

  // Position's own functions are not inlined where code shall be small.
  [[gnu::always_inline]] constexpr explicit ShortField(Position at) noexcept {
    const bool little = at.order == ByteOrder::little;
    const unsigned first =
        little ? at.start : at.start / 8U * 8U + 7U - at.start % 8U;  // Position::first_bit
    const unsigned last = first + at.width - 1U;
    bytes = last / 8 - first / 8 + 1;
    low = little ? first / 8 : last / 8;
    step = little ? 1 : -1;
    shift = little ? first % 8 : 7 - last % 8;
  }

  [[gnu::always_inline]] [[nodiscard]] constexpr unsigned place(unsigned i) const noexcept {
    return step > 0 ? low + i : low - i;
  }
  [[gnu::always_inline]] [[nodiscard]] constexpr std::uint32_t get(const std::uint8_t* data) const noexcept {
    std::uint32_t word = data[place(0)];
    if (bytes > 1) word |= std::uint32_t{data[place(1)]} << 8;
    if (bytes > 2) word |= std::uint32_t{data[place(2)]} << 16;
    if (bytes > 3) word |= std::uint32_t{data[place(3)]} << 24;
    return word >> shift;
  }
  [[gnu::always_inline]] static constexpr void mix(std::uint8_t& byte, std::uint32_t bits,
                                                   std::uint32_t mask) noexcept {
    byte = static_cast<std::uint8_t>((mask & 0xFF) == 0xFF ? bits : (byte & ~mask) | (bits & mask));
  }
  [[gnu::always_inline]] constexpr void put(std::uint8_t* data, std::uint32_t bits,
                                            std::uint32_t mask) const noexcept {
    bits <<= shift;
    mask <<= shift;
    mix(data[place(0)], bits, mask);
    if (bytes > 1) mix(data[place(1)], bits >> 8, mask >> 8);
    if (bytes > 2) mix(data[place(2)], bits >> 16, mask >> 16);
    if (bytes > 3) mix(data[place(3)], bits >> 24, mask >> 24);
  }
};

inline constexpr bool has_wide_registers = sizeof(void*) >= 8;

}  // namespace detail

/// The field's raw number. The bytes must hold the field, and T its width.
template <std::integral T, std::size_t Bytes>
[[gnu::always_inline]] [[nodiscard]] constexpr T read_field(const MessageBytes<Bytes>& bytes,
                                                            Position at) noexcept {
  if constexpr (!(detail::has_wide_registers && Bytes == 8) && sizeof(T) <= 4) {
    if (const detail::ShortField field{at}; field.bytes <= 4) {
      const std::uint32_t mask = ~std::uint32_t{0} >> (32 - at.width);
      const std::uint32_t bits = field.get(bytes.data()) & mask;
      const std::uint32_t sign = std::is_signed_v<T> ? (mask >> 1) + 1 : 0;
      return static_cast<T>(static_cast<std::int32_t>((bits ^ sign) - sign));
    }
  }
  if constexpr (Bytes == 8)
    return static_cast<T>(get(bytes, at, std::is_signed_v<T>));
  else
    return static_cast<T>(get(std::span<const std::uint8_t>{bytes}, at, std::is_signed_v<T>));
}

/// Puts a raw number. The other bits are kept. One that the width does not hold is put as the nearest that it
/// does: a velocity that is too large must not come out as one backwards.
template <std::integral T, std::size_t Bytes>
[[gnu::always_inline]] constexpr void write_field(MessageBytes<Bytes>& bytes, Position at, T value) noexcept {
  const T low = lowest_of<T>(at.width);
  const T high = highest_of<T>(at.width);
  const T held = value < low ? low : value > high ? high : value;
  if constexpr (!(detail::has_wide_registers && Bytes == 8) && sizeof(T) <= 4) {
    if (const detail::ShortField field{at}; field.bytes <= 4) {
      const std::uint32_t mask = ~std::uint32_t{0} >> (32 - at.width);
      return field.put(bytes.data(), static_cast<std::uint32_t>(held) & mask, mask);
    }
  }
  if constexpr (Bytes == 8)
    put(bytes, at, static_cast<std::int64_t>(held));
  else
    put(std::span<std::uint8_t>{bytes}, at, static_cast<std::int64_t>(held));
}

/// Puts the raw number of type T nearest to `value`, which is not rounded yet; see nearest_raw.
template <std::integral T, std::size_t Bytes>
[[gnu::always_inline]] constexpr void write_nearest(MessageBytes<Bytes>& bytes, Position at,
                                                    double value) noexcept {
  write_field(bytes, at, nearest_raw<T>(value, lowest_of<T>(at.width), highest_of<T>(at.width)));
}

}  // namespace ocm::protocol
