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
#include <span>
#include <type_traits>

#include "ocm/can/frame.hpp"

namespace ocm::protocol {

enum class ByteOrder : std::uint8_t { little, big };

/// A field's place in a frame, or in a message of several frames.
struct Position {
  std::uint16_t start = 0;  ///< see above; 0..63 in a classic frame, at most 14279
  std::uint8_t width = 0;   ///< 1..64
  ByteOrder order = ByteOrder::little;

  /// How many bytes a frame must have to hold the field.
  [[nodiscard]] constexpr unsigned bytes() const noexcept { return (first_bit() + width + 7U) / 8U; }

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
  /// The bits of byte `index` that the field takes.
  [[nodiscard]] constexpr std::uint8_t bits_in_byte(unsigned index) const noexcept {
    unsigned bits = 0;
    for (unsigned i = 0; i < 8; ++i) {
      const unsigned bit = 8 * index + i;
      if (bit < first_bit() || bit >= first_bit() + width) continue;
      bits |= order == ByteOrder::little ? 1U << i : 0x80U >> i;
    }
    return static_cast<std::uint8_t>(bits);
  }
  /// Whether two fields have a bit in common.
  [[nodiscard]] constexpr bool overlaps(const Position& other) const noexcept {
    const unsigned end = bytes() < other.bytes() ? bytes() : other.bytes();
    for (unsigned byte = (start > other.start ? start : other.start) / 8U; byte < end; ++byte)
      if ((bits_in_byte(byte) & other.bits_in_byte(byte)) != 0) return true;
    return false;
  }
  /// The field's first bit, counted through each byte from the end at which the byte order begins: a field's
  /// bits then follow each other without a jump.
  [[nodiscard]] constexpr unsigned first_bit() const noexcept {
    return order == ByteOrder::little ? start : start / 8U * 8U + (7U - start % 8U);
  }
  friend constexpr bool operator==(const Position&, const Position&) = default;
};

namespace detail {

/// The eight bytes as one number, first byte lowest (little) or highest (big).
[[nodiscard]] constexpr std::uint64_t load(const can::Payload& data, ByteOrder order) noexcept {
  const auto word = std::bit_cast<std::uint64_t>(data);
  return (order == ByteOrder::little) == (std::endian::native == std::endian::little)
             ? word
             : __builtin_bswap64(word);
}
constexpr void store(can::Payload& data, std::uint64_t word, ByteOrder order) noexcept {
  const bool native = (order == ByteOrder::little) == (std::endian::native == std::endian::little);
  data = std::bit_cast<can::Payload>(native ? word : __builtin_bswap64(word));
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

/// Run-time form. The position must be valid (`mask() != 0`). An unsigned field of 64 bits comes back as the
/// same bits: negative from 2^63 on.
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

/// The same for a frame of any length, which must hold the field: `data.size() >= position.bytes()`.
[[nodiscard]] constexpr std::int64_t get(std::span<const std::uint8_t> data, Position position,
                                         bool is_signed) noexcept {
  const unsigned first = position.first_bit();
  const unsigned last = first + position.width - 1U;
  std::uint64_t bits = 0;
  if (position.order == ByteOrder::little) {
    for (unsigned i = last / 8 + 1;
         i-- > first / 8;)  // a byte of which the lowest bits are above: shifted off
      bits = 8 * i >= first ? bits << 8 | data[i] : bits << (8 - first % 8) | data[i] >> first % 8;
  } else {
    const unsigned below = 7 - last % 8;  // bits of the last byte that are not the field's
    for (unsigned i = first / 8; i <= last / 8; ++i)
      bits = i < last / 8 ? bits << 8 | data[i] : bits << (8 - below) | data[i] >> below;
  }
  bits &= detail::low_mask(position.width);
  return is_signed ? detail::sign_extended(bits, position.width) : static_cast<std::int64_t>(bits);
}
/// Only the lowest `width` bits of `value` are put; the frame's other bits are kept.
constexpr void put(std::span<std::uint8_t> data, Position position, std::int64_t value) noexcept {
  const unsigned first = position.first_bit();
  const unsigned last = first + position.width - 1U;
  const bool little = position.order == ByteOrder::little;
  const auto bits = static_cast<std::uint64_t>(value) & detail::low_mask(position.width);
  for (unsigned i = first / 8; i <= last / 8; ++i) {
    // How far the field's lowest bit is above the lowest of this byte; below it, when negative.
    const int shift = little ? static_cast<int>(first) - static_cast<int>(8 * i)
                             : static_cast<int>(8 * i + 7) - static_cast<int>(last);
    const std::uint64_t byte = shift >= 0 ? bits << shift : bits >> -shift;
    const unsigned mask = position.bits_in_byte(i);
    data[i] = static_cast<std::uint8_t>((data[i] & ~mask) | (byte & mask));
  }
}

/// Compile-time form: a field of type T at a fixed position. T holds the width; the generator takes the
/// smallest.
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
    for (unsigned i = first; i <= last; ++i) {
      const Word value = data[place_of(i)];
      bits = static_cast<Word>(bits | (8 * i >= shift ? value << (8 * i - shift) : value >> (shift - 8 * i)));
    }
    if constexpr (Width < 8 * sizeof(Word)) {
      bits = static_cast<Word>(bits & detail::low_mask(Width));
      if constexpr (std::is_signed_v<T>) {
        constexpr Word sign = static_cast<Word>(Word{1} << (Width - 1));
        bits = static_cast<Word>((bits ^ sign) - sign);
      }
    }
    // By way of the signed type of the same width, in case T is wider.
    using Value = std::conditional_t<std::is_signed_v<T>, std::make_signed_t<Word>, Word>;
    return static_cast<T>(static_cast<Value>(bits));
  }

  /// The frame's other bits are kept. A value outside [min, max] is put as the nearer bound: a velocity that
  /// is too large must not come out as one backwards.
  static constexpr void put(can::Payload& data, T value) noexcept {
    if constexpr (Width < 8 * sizeof(T)) value = value < min ? min : value > max ? max : value;
    // One store of eight bytes, or the processor waits: eight small stores cannot be forwarded to the load of
    // the whole frame that follows. A Cortex-M has neither such registers nor that problem.
    if constexpr (sizeof(void*) >= 8)
      put_by_word(data, value);
    else
      put_by_bytes(data, value);
  }

  /// The two ways to put the lowest `Width` bits of `value`; same result.
  static constexpr void put_by_word(can::Payload& data, T value) noexcept {
    const std::uint64_t bits = (static_cast<std::uint64_t>(value) & detail::low_mask(Width)) << shift;
    detail::store(data, (detail::load(data, Order) & ~(detail::low_mask(Width) << shift)) | bits, Order);
  }
  static constexpr void put_by_bytes(can::Payload& data, T value) noexcept {
    const Word bits = static_cast<Word>(value);
    for (unsigned i = first; i <= last; ++i) {
      const auto byte =
          static_cast<std::uint8_t>(8 * i >= shift ? bits >> (8 * i - shift) : bits << (shift - 8 * i));
      std::uint8_t& place = data[place_of(i)];
      if constexpr (whole_bytes) {
        place = byte;
      } else {
        const unsigned from = i == first ? 0xFFU << shift % 8 : 0xFFU;
        const unsigned to = i == last ? 0xFFU >> (7 - (shift + Width - 1) % 8) : 0xFFU;
        place = static_cast<std::uint8_t>((place & ~(from & to)) | (byte & from & to));
      }
    }
  }

 private:
  // Wide enough that no shift loses a bit, and never 64 bits where 32 do: a Cortex-M has no 64-bit registers.
  using Word = std::conditional_t<(Width <= 32), std::uint32_t, std::uint64_t>;

  // Bytes are counted from the one with the field's order's lowest bits: the first of the frame, or the last.
  static constexpr unsigned shift = detail::shift_of(position);
  static constexpr unsigned first = shift / 8;
  static constexpr unsigned last = (shift + Width - 1) / 8;
  static constexpr bool whole_bytes = shift % 8 == 0 && Width % 8 == 0;
  static constexpr unsigned place_of(unsigned i) noexcept { return Order == ByteOrder::little ? i : 7 - i; }
};

}  // namespace ocm::protocol
