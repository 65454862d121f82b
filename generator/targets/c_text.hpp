/// C99 as the C targets write it: names, types, literals, and the bytes that a field lies in.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/text.hpp"
#include "ocm/protocol/topic.hpp"

#include "generator/spec/model.hpp"

namespace ocm::generate {

[[nodiscard]] inline std::string upper(std::string text) {
  for (char& c : text)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return text;
}

/// C has no ' between thousands.
[[nodiscard]] inline std::string without_marks(std::string text) {
  text.erase(std::remove(text.begin(), text.end(), '\''), text.end());
  return text;
}

[[nodiscard]] inline unsigned type_width(const spec::FieldModel& field) {
  const unsigned width = field.position.width;
  return width <= 8 ? 8 : width <= 16 ? 16 : width <= 32 ? 32 : 64;
}
[[nodiscard]] inline std::string type_of(const spec::FieldModel& field) {
  return (field.is_signed ? "int" : "uint") + std::to_string(type_width(field)) + "_t";
}

/// What the bits of a field are shifted in: no more than 32 where that will do, for a Cortex-M's sake.
[[nodiscard]] inline bool is_wide(const spec::FieldModel& field) {
  return field.position.width > 32;
}
[[nodiscard]] inline std::string word_type(const spec::FieldModel& field) {
  return is_wide(field) ? "uint64_t" : "uint32_t";
}

[[nodiscard]] inline std::string literal(std::int64_t number) {
  if (number == INT64_MIN) return "INT64_MIN";
  if (number == INT32_MIN) return "INT32_MIN";
  const std::string digits = std::to_string(number);
  if (number > UINT32_MAX || number < INT32_MIN) return "INT64_C(" + digits + ")";
  return number > INT32_MAX ? digits + "u" : digits;
}

[[nodiscard]] inline std::string word_literal(std::uint64_t number, bool wide) {
  base::Text<32> text;  // UINT64_C() and 18 characters
  text << (wide ? "UINT64_C(0x" : "0x");
  text.hex(number, number > 0xFFFF'FFFF ? 16 : number > 0xFFFF ? 8 : number > 0xFF ? 4 : 2);
  text << (wide ? ")" : "u");
  return std::string{text.view()};
}

/// The part of a field that lies in one byte of the frame.
struct Piece {
  unsigned byte = 0;   ///< of the frame
  unsigned shift = 0;  ///< of the piece's lowest bit, within the byte
  unsigned from = 0;   ///< the piece's lowest bit, within the field
  unsigned width = 0;
};

/// From the field's lowest bit on.
[[nodiscard]] inline std::vector<Piece> pieces_of(protocol::Position at) {
  std::vector<Piece> pieces;
  const bool little = at.order == protocol::ByteOrder::little;
  // Of big-endian fields: the bits of the frame counted from the highest of its first byte on.
  const unsigned last = at.start - at.start % 8 + (7 - at.start % 8) + at.width - 1;
  for (unsigned bit = 0; bit < at.width;) {
    const unsigned place = little ? at.start + bit : last - bit;
    const unsigned shift = little ? place % 8 : 7 - place % 8;
    const unsigned width = std::min(8 - shift, at.width - bit);
    pieces.push_back({place / 8, shift, bit, width});
    bit += width;
  }
  return pieces;
}

[[nodiscard]] inline std::string shifted(std::string text, std::string_view by, unsigned count) {
  return count == 0 ? text : "(" + text + " " + std::string{by} + " " + std::to_string(count) + ")";
}

[[nodiscard]] inline std::string masked(std::string text, unsigned width) {
  return width == 8 ? text : "(" + text + " & " + word_literal((1U << width) - 1, false) + ")";
}

}  // namespace ocm::generate
