/// An update that lies whole in memory, as on a server that reads a robot's line in blocks: a number a step,
/// its characters in one word, and no jump that depends on its length or sign. The reader's short cut
/// (sentence_reader.hpp): what is not taken here, right or wrong, the reader takes a character at a time.
///
/// No heap, constexpr, any byte order and alignment; O(1), some 50 instructions a number on a 64-bit machine.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "ocm/base/swar.hpp"
#include "ocm/mapper/link/sentence.hpp"

namespace ocm::mapper::link::detail {

using base::swar::each;

/// A number that other text follows.
struct ShortNumber {
  std::size_t size = 0;  ///< characters; 0: not one of at most four digits, as a robot prints it
  std::int16_t value = 0;
};

/// The least magnitude that is printed in so many characters, without and with a sign: no 007, no -0.
inline constexpr std::int16_t none = 10'000;
inline constexpr std::int16_t least_magnitude[2][9] = {{none, 0, 10, 100, 1000, none, none, none, none},
                                                       {none, none, 1, 10, 100, 1000, none, none, none}};

[[nodiscard]] constexpr ShortNumber short_number(std::uint64_t text) noexcept {
  // The lowest byte outside '-' to '9' gets its highest bit: carries come from there, and only go up.
  const std::uint64_t ends = ((text - each('-')) | (text + each(0x7F - '9'))) & each(0x80);
  const unsigned bits = static_cast<unsigned>(std::countr_zero(ends)) & ~7U;  // in front of it
  const unsigned negative = (text & 0xFF) == '-' ? 1 : 0;
  // The last digit comes on top, zeros below the first; a sign becomes a zero as well.
  const std::uint64_t digits = (text ^ each('0') ^ negative * ('-' ^ '0')) << (64 - bits) % 64;
  const auto last = static_cast<std::uint32_t>(digits >> 32);
  const bool strange = (last & 0x1010'1010) != 0;  // one is '-', '.' or '/'
  const std::uint32_t pairs = (last * 10 + (last >> 8)) & 0x00FF'00FF;
  const auto magnitude = static_cast<std::int32_t>(pairs * (std::uint32_t{100} << 16 | 1) >> 16);
  if (strange || magnitude < least_magnitude[negative][bits / 8]) return {};
  return {bits / 8, static_cast<std::int16_t>(negative != 0 ? -magnitude : magnitude)};
}

/// Characters that are looked at, at most: seven longest numbers, and the word of the eighth.
inline constexpr std::size_t whole_update_room = 3 + 7 * 6 + 8;

/// How many characters the update has that begins with the text's brace; 0: none that is taken. The integers
/// may have changed then.
template <std::size_t N>
[[nodiscard]] constexpr std::size_t whole_update(std::string_view text,
                                                 std::array<std::int16_t, N>& integers) noexcept {
  constexpr std::size_t count = Update::fields.size();
  if (text.size() < whole_update_room || text[1] != Update::letter || text[2] != ',') return 0;
  std::size_t at = 3;
  for (std::size_t i = 0; i < count; ++i) {
    const ShortNumber number = short_number(base::swar::load64(text.data() + at));
    if (number.size == 0 || number.value < Update::fields[i].min || number.value > Update::fields[i].max)
      return 0;
    at += number.size;
    if (text[at++] != (i + 1 < count ? ',' : '}')) return 0;
    integers[i] = number.value;
  }
  return at;
}

}  // namespace ocm::mapper::link::detail
