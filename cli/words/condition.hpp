/// Conditions on a field's value, as people type them: `Engine.Speed>3000`, `Doors.Locked=yes`.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "ocm/base/decimal.hpp"
#include "ocm/base/result.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/words/value.hpp"

namespace ocm::cli::words {

enum class Comparison : std::uint8_t { equal, different, less, at_most, greater, at_least };

/// The parts of a condition; they point into its text.
struct ConditionWords {
  std::string_view field;
  Comparison comparison = Comparison::equal;
  std::string_view value;
};

/// At the first `<`, `>`, `=` or `!`; `==` is `=`. Blanks around the parts are left out. bad_syntax: there is
/// no such sign, or nothing on one side of it.
[[nodiscard]] constexpr base::Result<ConditionWords> split_condition(std::string_view text) noexcept {
  const std::size_t at = text.find_first_of("<>=!");
  if (at == std::string_view::npos) return base::Error::bad_syntax;
  const bool and_equal = at + 1 < text.size() && text[at + 1] == '=';
  ConditionWords words;
  switch (text[at]) {
    case '<':
      words.comparison = and_equal ? Comparison::at_most : Comparison::less;
      break;
    case '>':
      words.comparison = and_equal ? Comparison::at_least : Comparison::greater;
      break;
    case '!':
      if (!and_equal) return base::Error::bad_syntax;
      words.comparison = Comparison::different;
      break;
    default:
      words.comparison = Comparison::equal;
  }
  const auto trimmed = [](std::string_view part) {
    while (part.starts_with(' ')) part.remove_prefix(1);
    while (part.ends_with(' ')) part.remove_suffix(1);
    return part;
  };
  words.field = trimmed(text.substr(0, at));
  words.value = trimmed(text.substr(at + (and_equal ? 2 : 1)));
  if (words.field.empty() || words.value.empty()) return base::Error::bad_syntax;
  return words;
}

/// What a field is compared with: a number in its unit, or a named value.
class Condition {
 public:
  Condition() = default;  ///< of no field: not to be asked
  /// The error is said in words, with what the field takes.
  [[nodiscard]] static base::Result<Condition, std::string> of(const protocol::Field& field,
                                                               Comparison comparison,
                                                               std::string_view value) {
    Condition condition{field, comparison};
    condition.named_ = detail::named_raw(field, value);
    if (condition.named_) return condition;
    for (const auto& named : field.values)
      if (field.flags && named.name == value) {
        condition.named_ = named.raw;
        if (comparison != Comparison::equal && comparison != Comparison::different)
          return "a flag is set or not: write " + std::string{field.name} + '=' + std::string{value};
        return condition;
      }
    if (const auto decimal = detail::decimal_of_hexadecimal(value)) return of(field, comparison, *decimal);
    const std::string_view whole = value.starts_with('+') ? value.substr(1) : value;
    if (!field.unit.empty() && value.size() > field.unit.size() && value.ends_with(field.unit)) {
      value.remove_suffix(field.unit.size());
      while (value.ends_with(' ')) value.remove_suffix(1);
    }
    auto number = base::parse_decimal(value.starts_with('+') ? value.substr(1) : value);
    if (!number)  // in a unit of the same kind
      if (const auto quantity = parse_quantity(whole);
          quantity && !quantity->unit.empty() && !field.unit.empty())
        number = convert(*quantity, field.unit);
    if (!number) {
      // A whole word has numbers of more digits than a decimal: compared as raw ones, if they are the same.
      const bool is_raw = field.scale == base::Decimal{1, 0} && field.offset.digits == 0;
      const auto wide = detail::parse_wide(field, value.starts_with('+') ? value.substr(1) : value);
      if (!is_raw || !wide) return detail::takes(field);
      condition.named_ = *wide;
      return condition;
    }
    condition.number_ = *number;
    return condition;
  }

  /// Of the raw number of a frame that has the field. Exact, but for floats and where the digits are too
  /// many; nothing is equal to NaN, less or greater.
  [[nodiscard]] bool holds(std::int64_t raw) const noexcept {
    if (named_ && field_->flags) return ((raw >> *named_ & 1) != 0) == (comparison_ == Comparison::equal);
    if (named_) {
      const std::uint64_t sign =
          field_->is_signed || field_->position.width < 64 ? std::uint64_t{1} << 63 : 0;
      const std::uint64_t own = static_cast<std::uint64_t>(raw) ^ sign;
      const std::uint64_t named = static_cast<std::uint64_t>(*named_) ^ sign;
      return is(own < named ? -1 : own > named ? 1 : 0);
    }
    if (!field_->is_float())
      if (const auto physical = field_->physical(raw)) return is(base::compare(*physical, number_));
    const double value = field_->value(raw);
    const double other = number_.as_double();
    if (value != value) return comparison_ == Comparison::different;
    return is(value < other ? -1 : value > other ? 1 : 0);
  }

 private:
  Condition(const protocol::Field& field, Comparison comparison) : field_(&field), comparison_(comparison) {}

  /// `order`: below 0 less, 0 equal, above 0 greater.
  [[nodiscard]] bool is(int order) const noexcept {
    switch (comparison_) {
      case Comparison::equal:
        return order == 0;
      case Comparison::different:
        return order != 0;
      case Comparison::less:
        return order < 0;
      case Comparison::at_most:
        return order <= 0;
      case Comparison::greater:
        return order > 0;
      case Comparison::at_least:
        break;
    }
    return order >= 0;
  }

  const protocol::Field* field_ = nullptr;
  Comparison comparison_ = Comparison::equal;
  base::Decimal number_{};
  std::optional<std::int64_t> named_;  ///< raw: of a name, or of too many digits; of flags the bit
};

}  // namespace ocm::cli::words
