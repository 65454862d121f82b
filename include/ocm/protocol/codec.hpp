/// Where a number lies in a frame, and how it is put there and got back: any width of 1 to 64 bits at any
/// bit, either byte order, signed or not. The generated encoders use the template form (positions known to
/// the compiler, which folds it into plain loads and shifts); the catalogue's decoder uses the run-time form.
/// Both share one definition of a position.
///
/// Bits are numbered as in DBC: bit b is bit b % 8 of byte b / 8. `start` is the least significant bit of a
/// little-endian field, the most significant bit of a big-endian one; from there a big-endian field goes down
/// to bit 0 of its byte and on from bit 7 of the next byte.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "ocm/can/frame.hpp"

namespace ocm::protocol {

enum class ByteOrder : std::uint8_t { little, big };

/// A field's place in the eight bytes of a frame.
struct Position {
  std::uint8_t start = 0;  ///< 0..63, see above
  std::uint8_t width = 0;  ///< 1..64
  ByteOrder order = ByteOrder::little;

  /// The bits that the field takes, as a mask over the frame: bit b of the mask is bit b of the frame. 0 when
  /// the field does not fit into eight bytes.
  [[nodiscard]] constexpr std::uint64_t mask() const noexcept {
    if (width == 0 || width > 64 || start > 63) return 0;
    std::uint64_t mask = 0;
    unsigned bit = start;
    for (unsigned i = 0; i < width; ++i) {
      if (bit > 63) return 0;
      mask |= std::uint64_t{1} << bit;
      bit = order == ByteOrder::little ? bit + 1 : bit % 8 != 0 ? bit - 1 : bit + 15;
    }
    return mask;
  }
  friend constexpr bool operator==(const Position&, const Position&) = default;
};

namespace detail {

/// The eight bytes as one number, first byte lowest (little) or highest (big).
[[nodiscard]] constexpr std::uint64_t load(const can::Payload& data, ByteOrder order) noexcept {
  std::uint64_t word = 0;
  for (unsigned i = 0; i < 8; ++i)
    word |= std::uint64_t{data[i]} << (order == ByteOrder::little ? 8 * i : 56 - 8 * i);
  return word;
}
constexpr void store(can::Payload& data, std::uint64_t word, ByteOrder order) noexcept {
  for (unsigned i = 0; i < 8; ++i)
    data[i] = static_cast<std::uint8_t>(word >> (order == ByteOrder::little ? 8 * i : 56 - 8 * i));
}
/// Distance of the field's lowest bit from the lowest bit of `load`'s number.
[[nodiscard]] constexpr unsigned shift_of(Position p) noexcept {
  if (p.order == ByteOrder::little) return p.start;
  const unsigned from_top = p.start / 8 * 8 + (7 - p.start % 8);  // of the most significant bit
  return 64 - from_top - p.width;
}
[[nodiscard]] constexpr std::uint64_t low_mask(unsigned width) noexcept {
  return width >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << width) - 1;
}
[[nodiscard]] constexpr std::int64_t sign_extended(std::uint64_t bits, unsigned width) noexcept {
  const std::uint64_t sign = std::uint64_t{1} << (width - 1);
  return static_cast<std::int64_t>((bits ^ sign) - sign);
}

}  // namespace detail

/// Lowest and highest number that a field of this width holds; an unsigned field of 64 bits is limited to
/// 2^63 - 1.
[[nodiscard]] constexpr std::int64_t lowest(unsigned width, bool is_signed) noexcept {
  if (!is_signed) return 0;
  return width >= 64 ? INT64_MIN : -(std::int64_t{1} << (width - 1));
}
[[nodiscard]] constexpr std::int64_t highest(unsigned width, bool is_signed) noexcept {
  const unsigned magnitude_bits = is_signed ? width - 1 : width;
  return magnitude_bits >= 63 ? INT64_MAX : (std::int64_t{1} << magnitude_bits) - 1;
}

/// Run-time form. The position must be valid (`mask() != 0`).
[[nodiscard]] constexpr std::int64_t get(const can::Payload& data, Position position,
                                         bool is_signed) noexcept {
  const std::uint64_t bits =
      detail::load(data, position.order) >> detail::shift_of(position) & detail::low_mask(position.width);
  return is_signed ? detail::sign_extended(bits, position.width) : static_cast<std::int64_t>(bits);
}
/// Run-time form; only the lowest `width` bits of `value` are put.
constexpr void put(can::Payload& data, Position position, std::int64_t value) noexcept {
  const unsigned shift = detail::shift_of(position);
  const std::uint64_t mask = detail::low_mask(position.width) << shift;
  std::uint64_t word = detail::load(data, position.order);
  word = (word & ~mask) | (static_cast<std::uint64_t>(value) << shift & mask);
  detail::store(data, word, position.order);
}

/// Compile-time form: a field of type T at a fixed position. T is the smallest integer that holds the width.
template <class T, unsigned Start, unsigned Width = 8 * sizeof(T), ByteOrder Order = ByteOrder::little>
struct Bits {
  static_assert(std::is_integral_v<T>);
  static constexpr Position position{Start, Width, Order};
  static_assert(position.mask() != 0, "the field does not fit into eight bytes");
  static_assert(Width <= 8 * sizeof(T), "the type is too narrow for the field");

  /// Bounds of a width that is not the type's own, such as 12 or 24 bits.
  static constexpr T min = static_cast<T>(lowest(Width, std::is_signed_v<T>));
  static constexpr T max = Width == 64 && !std::is_signed_v<T>
                               ? static_cast<T>(~T{0})
                               : static_cast<T>(highest(Width, std::is_signed_v<T>));

  [[nodiscard]] static constexpr T get(const can::Payload& data) noexcept {
    Word bits = 0;
    each_byte([&](unsigned byte, int shift) {
      const Word value = data[byte];
      bits = static_cast<Word>(bits | (shift >= 0 ? value << shift : value >> -shift));
    });
    if constexpr (Width < 8 * sizeof(Word)) {
      bits = static_cast<Word>(bits & detail::low_mask(Width));
      if constexpr (std::is_signed_v<T>) {
        constexpr Word sign = static_cast<Word>(Word{1} << (Width - 1));
        bits = static_cast<Word>((bits ^ sign) - sign);
      }
    }
    return static_cast<T>(bits);
  }

  /// The frame's other bits are kept. A value outside [min, max] is put as the nearer bound: a velocity that
  /// is too large must not come out as one backwards.
  static constexpr void put(can::Payload& data, T value) noexcept {
    if constexpr (Width < 8 * sizeof(T)) value = value < min ? min : value > max ? max : value;
    const Word bits =
        static_cast<Word>(static_cast<Word>(value) & static_cast<Word>(detail::low_mask(Width)));
    each_byte([&](unsigned byte, int shift) {
      const std::uint8_t taken = static_cast<std::uint8_t>(position.mask() >> (8 * byte));
      const std::uint8_t value_bits = static_cast<std::uint8_t>(shift >= 0 ? bits >> shift : bits << -shift);
      data[byte] = static_cast<std::uint8_t>((data[byte] & ~taken) | (value_bits & taken));
    });
  }

 private:
  // Wide enough that no shift loses a bit, and never 64 bits where 32 do: a Cortex-M has no 64-bit registers.
  using Word = std::conditional_t<(Width <= 32), std::uint32_t, std::uint64_t>;

  /// Calls `f(byte, shift)` for each byte of the field, where `shift` is how far the byte's bit 0 lies above
  /// the field's bit 0.
  template <class F>
  static constexpr void each_byte(F&& f) noexcept {
    constexpr unsigned shift = detail::shift_of(position);
    constexpr unsigned first = shift / 8;
    constexpr unsigned last = (shift + Width - 1) / 8;
    for (unsigned i = first; i <= last; ++i)
      f(Order == ByteOrder::little ? i : 7 - i, static_cast<int>(8 * i) - static_cast<int>(shift));
  }
};

}  // namespace ocm::protocol
