/// A field's physical value as text, exactly: the same characters as
/// base::to_text(field.physical(field.raw(data))), in a few nanoseconds. What the field's scale and offset
/// say is worked out once: physical = (raw * factor + offset) / 10^places, in whole numbers. A float has as
/// few digits as give it back; what is no number is NaN, Infinity or -Infinity.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <utility>

#include "ocm/base/decimal.hpp"
#include "ocm/protocol/codec.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/output/digits.hpp"

namespace ocm::cli {

namespace detail {

/// What width, sign, kind of number, scale and offset of a field say of its text. Of thousands of fields few
/// are different, so that those which all share stay in the processor's first cache.
class FieldShape {
 public:
  explicit FieldShape(const protocol::Field& field);

  /// Whether raw * factor + offset is right, in 63 bits, for every raw number.
  [[nodiscard]] bool whole_numbers() const noexcept { return whole_numbers_; }
  [[nodiscard]] bool tabled() const noexcept { return table_ != nullptr; }
  [[nodiscard]] std::int64_t raw(std::uint64_t bits) const noexcept {
    return static_cast<std::int64_t>((bits ^ sign_) - sign_);
  }
  /// tabled(): a text by the field's bits. A table of its own, so that a value costs one look into memory.
  struct ShortText {
    char characters[7];
    std::uint8_t size;
  };
  [[nodiscard]] const ShortText* table() const noexcept { return table_.get(); }
  static char* print_tabled(char* to, const ShortText* table, std::uint64_t bits) noexcept {
    const ShortText& text = table[static_cast<std::size_t>(bits)];
    std::memcpy(to, &text, sizeof text);  // all 8 bytes: of how many is not guessed
    return to + text.size;
  }
  /// whole_numbers()
  char* print_raw(char* to, std::int64_t raw) const noexcept {
    return print_whole(to, raw * factor_ + offset_);
  }

 private:
  /// Of up to this many bits all texts are worked out once: most fields of a car are so narrow.
  static constexpr unsigned most_tabled_bits = 8;

  void tabulate(unsigned width);
  /// Whether the whole numbers suffice for every raw number that the field can have.
  bool work_out(const protocol::Field& field) noexcept {
    if (field.is_float()) return false;
    const base::Decimal scale = field.scale;
    const base::Decimal offset = field.offset;
    int exponent = std::min<int>(scale.exponent, offset.digits == 0 ? scale.exponent : offset.exponent);
    exponent = std::min(exponent, 0);
    if (exponent < -18) return false;
    const auto factor = base::detail::scaled(scale.digits, scale.exponent - exponent);
    const auto shift = offset.digits == 0 ? base::Result<std::int64_t>{std::int64_t{0}}
                                          : base::detail::scaled(offset.digits, offset.exponent - exponent);
    if (!factor || !shift) return false;
    const bool any_sign = field.is_signed || field.position.width >= 64;
    const unsigned width = field.position.width;
    for (const std::int64_t raw : {protocol::lowest(width, any_sign), protocol::highest(width, any_sign)}) {
      std::int64_t product = 0;
      std::int64_t sum = 0;
      if (__builtin_mul_overflow(raw, *factor, &product) || __builtin_add_overflow(product, *shift, &sum))
        return false;
    }
    factor_ = *factor;
    offset_ = *shift;
    places_ = -exponent;
    return true;
  }

  /// value / 10^places.
  char* print_whole(char* to, std::int64_t value) const noexcept {
    const std::uint64_t magnitude = base::detail::magnitude(value);
    *to = '-';
    to += value < 0 ? 1 : 0;
    if (magnitude >= ten_to_8 || places_ >= 8) return print_long(to, magnitude);
    const std::uint64_t digits = eight_digits(static_cast<std::uint32_t>(magnitude));
    const int whole = 8 - places_;  // digits before the point, at least one of which is written
    const int first = std::min(std::countr_zero(digits | std::uint64_t{1} << 56) / 8, whole - 1);
    const std::uint64_t text = digits | ascii_zeros;
    put_word(to, text >> 8 * first);
    to += whole - first;
    if (places_ == 0) return to;
    *to = '.';
    put_word(to + 1, text >> 8 * whole);
    const int last = (71 - std::countl_zero(digits >> 8 * whole)) / 8;  // of the digits behind the point
    return last == 0 ? to : to + 1 + last;
  }

  /// Up to 19 digits, and up to 18 of them behind the point: 24 digits in three words.
  char* print_long(char* to, std::uint64_t magnitude) const noexcept {
    const auto digits_of = [](std::uint64_t number) {
      return eight_digits(static_cast<std::uint32_t>(number));
    };
    const std::uint64_t words[3] = {digits_of(magnitude / ten_to_8 / ten_to_8),
                                    digits_of(magnitude / ten_to_8 % ten_to_8),
                                    digits_of(magnitude % ten_to_8)};
    char text[48];  // the second half is only copied
    for (int i = 0; i < 3; ++i) put_word(text + 8 * i, words[i] | ascii_zeros);
    const int leading = words[0] != 0   ? std::countr_zero(words[0]) / 8
                        : words[1] != 0 ? 8 + std::countr_zero(words[1]) / 8
                                        : 16 + std::countr_zero(words[2] | std::uint64_t{1} << 56) / 8;
    const int last = words[2] != 0   ? 24 - std::countl_zero(words[2]) / 8
                     : words[1] != 0 ? 16 - std::countl_zero(words[1]) / 8
                                     : 8 - std::countl_zero(words[0]) / 8;
    const int whole = 24 - places_;
    const int first = std::min(leading, whole - 1);
    std::memcpy(to, text + first, 24);
    to += whole - first;
    if (last <= whole) return to;
    *to++ = '.';
    std::memcpy(to, text + whole, 24);
    return to + (last - whole);
  }

  std::int64_t factor_ = 1;
  std::int64_t offset_ = 0;
  std::uint64_t sign_ = 0;
  int places_ = 0;
  bool whole_numbers_ = false;
  std::unique_ptr<ShortText[]>
      table_;  ///< by the field's bits; none: they are too many, or the texts too long
};

/// The shape of a field; the same one for all fields that have it. It is kept until the program ends.
[[nodiscard]] const FieldShape& shape_of(const protocol::Field& field);

}  // namespace detail

class FieldText {
 public:
  /// Most bytes that `print` may write, those behind the end of the text included.
  static constexpr std::size_t room = 160;

  /// `field` must outlive this.
  explicit FieldText(const protocol::Field& field) : field_(&field) {
    const detail::FieldShape& shape = detail::shape_of(field);
    shape_ = &shape;
    const unsigned width = field.position.width;
    const unsigned first = field.position.first_bit();
    // Eight bytes that hold the field, within the first eight or 64, or with eight more behind them: see
    // can::FrameView and j1939::Transported.
    const unsigned end = field.position.bytes();
    const unsigned byte = end <= 8 ? 0 : end <= 64 ? std::min(first / 8, 56U) : first / 8;
    const unsigned within = first - 8 * byte;
    byte_ = static_cast<std::uint16_t>(byte);
    swapped_ = field.position.order == protocol::ByteOrder::big;
    is_float_ = field.is_float();
    in_word_ = within + width <= 64;
    if (!in_word_) return;
    left_ = static_cast<std::uint8_t>(swapped_ ? within : 64 - within - width);
    right_ = static_cast<std::uint8_t>(64 - width);
    if (field.is_derived()) return;
    if (shape.tabled()) {
      way_ = Way::tabled;
      table_ = shape.table();
    } else if (shape.whole_numbers() &&
               (field.is_signed || width < 64))  // of an unsigned word the highest bit is no sign
      way_ = Way::whole;
  }

  /// Writes the value of the field in `data`, which holds it and has room behind it as can::FrameView says;
  /// returns the end.
  char* print(char* to, const std::uint8_t* data) const noexcept {
    if (way_ == Way::tabled) return detail::FieldShape::print_tabled(to, table_, bits(data));
    return print_untabled(to, data);
  }

  char* print(char* to, const can::Payload& data) const noexcept { return print(to, data.data()); }
  /// The same as JSON, which has no numbers for NaN and the infinities: strings, as protocol buffers have
  /// them.
  char* print_json(char* to, const std::uint8_t* data) const noexcept {
    if (way_ == Way::tabled) return detail::FieldShape::print_tabled(to, table_, bits(data));
    return is_float_ ? print_json_float(to, raw(data)) : print_untabled(to, data);
  }

  [[nodiscard]] const protocol::Field& field() const noexcept { return *field_; }
  /// As field().raw(data).
  [[nodiscard]] std::int64_t raw(const std::uint8_t* data) const noexcept {
    if (!in_word_) return raw_by_bytes(data);
    if (way_ != Way::tabled) return shape_->raw(bits(data));
    const std::uint64_t sign = field_->is_signed ? std::uint64_t{1} << (field_->position.width - 1) : 0;
    return static_cast<std::int64_t>((bits(data) ^ sign) - sign);  // its table is known, and not its shape
  }

  /// Whether eight bytes hold the field: all but such as are wider than 57 bits.
  [[nodiscard]] bool in_word() const noexcept { return in_word_; }
  /// in_word(): the field's bits.
  [[nodiscard]] std::uint64_t bits(const std::uint8_t* data) const noexcept {
    std::uint64_t word = 0;
    std::memcpy(&word, data + byte_, sizeof word);
    if (swapped_) word = __builtin_bswap64(word);
    return word << left_ >> right_;
  }

 private:
  enum class Way : std::uint8_t { slow, whole, tabled };

  /// Apart, so that what most fields need is inlined where they are printed.
  char* print_untabled(char* to, const std::uint8_t* data) const noexcept;
  char* print_slowly(char* to, std::int64_t raw) const noexcept;
  char* print_json_float(char* to, std::int64_t raw) const noexcept;
  /// Of a field of which the bits are in nine bytes, too.
  [[nodiscard]] std::int64_t raw_by_bytes(const std::uint8_t* data) const noexcept;

  // 24 bytes: the fields of thousands of messages come in random order, and are to stay in the processor's
  // second cache.
  const protocol::Field* field_;
  union {
    const detail::FieldShape* shape_;
    const detail::FieldShape::ShortText* table_;  ///< Way::tabled
  };
  std::uint16_t byte_ = 0;
  std::uint8_t left_ = 0;
  std::uint8_t right_ = 0;
  Way way_ = Way::slow;
  bool swapped_ = false;
  bool in_word_ = true;
  bool is_float_ = false;
};

}  // namespace ocm::cli
