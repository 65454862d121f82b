#include "cli/output/field_text.hpp"

#include <cmath>
#include <map>
#include <string_view>
#include <tuple>

#include <fmt/format.h>

namespace ocm::cli {
namespace {

// GCC and clang have it wherever the tool runs; on the 32-bit board digits and offset have 64 bits.
#ifdef __SIZEOF_INT128__
__extension__ using Wide = __int128;
#else
using Wide = std::int64_t;
#endif

/// number * 10^places, or false.
bool scale_up(Wide& number, int places) noexcept {
  for (; places > 0; --places)
    if (__builtin_mul_overflow(number, Wide{10}, &number)) return false;
  return true;
}

/// raw * scale + offset as `number` * 10^-places, places >= 0; false where that needs more bits than there
/// are.
bool exactly(const protocol::Field& field, std::int64_t raw, Wide& number, int& places) noexcept {
  const bool whole_word = !field.is_signed && field.position.width == 64;
  number = whole_word && sizeof(Wide) > 8 ? static_cast<Wide>(static_cast<std::uint64_t>(raw)) : Wide{raw};
  if (whole_word && sizeof(Wide) == 8 && raw < 0) return false;
  const auto [digits, exponent] = field.scale;
  const auto [offset_digits, offset_exponent] = field.offset;
  if (__builtin_mul_overflow(number, Wide{digits}, &number)) return false;
  int least = std::min<int>(exponent, 0);
  if (offset_digits != 0) least = std::min<int>(least, offset_exponent);
  Wide offset = offset_digits;
  if (!scale_up(number, exponent - least)) return false;
  if (offset_digits != 0 && !scale_up(offset, offset_exponent - least)) return false;
  if (__builtin_add_overflow(number, offset, &number)) return false;
  places = -least;
  return true;
}

char* put_literal(char* to, std::string_view text) noexcept {
  std::memcpy(to, text.data(), text.size());
  return to + text.size();
}

char* put_wide(char* to, Wide number, int places) noexcept {
  if (number < 0) *to++ = '-';
  char digits[48];
  int count = 0;
  if (number >= 0 && number <= static_cast<Wide>(UINT64_MAX))  // 18 times as fast as 128 bits
    for (auto rest = static_cast<std::uint64_t>(number); rest != 0; rest /= 10, number = 0)
      digits[count++] = static_cast<char>('0' + rest % 10);
  for (; number != 0 || count <= places; ++count, number /= 10) {
    const int digit = static_cast<int>(number % 10);
    digits[count] = static_cast<char>('0' + (digit < 0 ? -digit : digit));
  }
  int last = 0;  // zeros at the end behind the point say nothing
  while (last < places && digits[last] == '0') ++last;
  for (int i = count - 1; i >= last; --i) {
    *to++ = digits[i];
    if (i == places && i != last) *to++ = '.';
  }
  return to;
}

/// The shortest that reads back as the same number: fmt's, whose tables are here anyway; those of
/// std::to_chars would be 150 kB on the operator's board.
template <class Float>
char* put_float(char* to, Float value) noexcept {
  if (std::isnan(value)) return put_literal(to, "NaN");
  if (std::isinf(value)) return put_literal(to, value < 0 ? "-Infinity" : "Infinity");
  return fmt::format_to(to, "{}", value);
}

}  // namespace

namespace detail {

FieldShape::FieldShape(const protocol::Field& field)
    : sign_(field.is_signed ? std::uint64_t{1} << (field.position.width - 1) : 0),
      whole_numbers_(work_out(field)) {
  if (whole_numbers_ && field.position.width <= most_tabled_bits) tabulate(field.position.width);
}

void FieldShape::tabulate(unsigned width) {
  const std::size_t count = std::size_t{1} << width;
  auto table = std::make_unique<ShortText[]>(count);
  for (std::size_t bits = 0; bits < count; ++bits) {
    char text[FieldText::room];
    const auto size = static_cast<std::size_t>(print_raw(text, raw(bits)) - text);
    if (size > sizeof table[bits].characters) return;  // a scale of many digits
    std::copy_n(text, size, table[bits].characters);
    table[bits].size = static_cast<std::uint8_t>(size);
  }
  table_ = std::move(table);
}

const FieldShape& shape_of(const protocol::Field& field) {
  using Key = std::tuple<unsigned, bool, protocol::Number, std::int64_t, int, std::int64_t, int>;
  static std::map<Key, FieldShape> shapes;
  const Key key{field.position.width, field.is_signed,     field.number,         field.scale.digits,
                field.scale.exponent, field.offset.digits, field.offset.exponent};
  return shapes.try_emplace(key, field).first->second;
}

}  // namespace detail

char* FieldText::print_untabled(char* to, const std::uint8_t* data) const noexcept {
  if (way_ == Way::whole) return shape_->print_raw(to, shape_->raw(bits(data)));
  return print_slowly(to, raw(data));
}

char* FieldText::print_slowly(char* to, std::int64_t raw) const noexcept {
  const protocol::Field& field = *field_;
  if (field.is_derived()) {  // a decimal, or where the law says nothing, what has no such
    const auto value = field.physical(raw);
    return value ? put_literal(to, base::to_text(*value).view()) : put_float(to, field.value(raw));
  }
  if (shape_->whole_numbers() && (raw >= 0 || field.is_signed || field.position.width < 64))
    return shape_->print_raw(to, raw);
  const bool plain = field.scale == base::Decimal{1, 0} && field.offset.digits == 0;
  if (field.number == protocol::Number::float32 && plain)
    return put_float(to, static_cast<float>(field.unscaled(raw)));
  if (is_float_) return put_float(to, field.value(raw));
  Wide number = 0;
  int places = 0;
  if (exactly(field, raw, number, places) && places < 40) return put_wide(to, number, places);
  return put_float(to, field.value(raw));
}

char* FieldText::print_json_float(char* to, std::int64_t raw) const noexcept {
  if (std::isfinite(field_->value(raw))) return print_slowly(to, raw);
  *to = '"';
  to = print_slowly(to + 1, raw);
  *to = '"';
  return to + 1;
}

std::int64_t FieldText::raw_by_bytes(const std::uint8_t* data) const noexcept {
  return field_->raw(std::span{data, field_->position.bytes()});
}

}  // namespace ocm::cli
