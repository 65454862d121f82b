/// Numbers for a topic's fields, as people type them and as programs write them.
#pragma once

#include <charconv>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "ocm/base/decimal.hpp"
#include "ocm/base/result.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/words/quantity.hpp"
#include "cli/words/suggestion.hpp"
#include "cli/words/wide_number.hpp"

namespace ocm::cli::words {

/// The greatest raw number that a field takes; of an unsigned word, for which raw_max has no room, its bits.
[[nodiscard]] constexpr std::int64_t greatest_raw(const protocol::Field& field) noexcept {
  const bool any_word =
      !field.is_signed && field.position.width == 64 && field.raw_min == 0 && field.raw_max == INT64_MAX;
  return any_word ? -1 : field.raw_max;
}

/// A raw number in the field's unit; 15 digits of it where a Decimal has not the room for all.
[[nodiscard]] inline std::string physical_text(const protocol::Field& field, std::int64_t raw) {
  if (const auto physical = field.physical(raw)) return std::string{base::to_text(*physical).view()};
  const bool plain = field.scale == base::Decimal{1, 0} && field.offset.digits == 0;
  if (plain) return std::to_string(static_cast<std::uint64_t>(raw));  // of a signed field it is a Decimal
  char text[32];
  std::snprintf(text, sizeof text, "%.15g", field.value(raw));
  return text;
}

namespace detail {

[[nodiscard]] inline std::string quoted(std::string_view word) {
  return "'" + std::string{word} + "'";
}

/// "x takes -1 to 1 m/s", with the names that the field's values have.
[[nodiscard]] inline std::string takes(const protocol::Field& field) {
  if (field.is_derived())
    return std::string{field.name} + " is " + std::string{base::to_text(field.min).view()} + " to " +
           std::string{base::to_text(field.max).view()} + ' ' + std::string{field.unit};
  const auto stated = [&field](base::Decimal bound, std::int64_t raw) {
    return field.min == field.max ? physical_text(field, raw) : std::string{base::to_text(bound).view()};
  };
  std::string expected =
      field.is_float() && field.min == field.max
          ? std::string{"any number"}
          : stated(field.min, field.raw_min) + " to " + stated(field.max, greatest_raw(field));
  if (!field.unit.empty()) expected += " " + std::string{field.unit};
  if (!field.flags && !field.values.empty()) {
    std::string names;
    for (const auto& value : field.values) names.append(names.empty() ? "" : ", ").append(value.name);
    expected = names + ", or " + expected;
  }
  return std::string{field.name} + " takes " + expected;
}

/// "did you mean 'Reverse'? ", whatever the case; empty: no name of a value is near.
[[nodiscard]] inline std::string near_name(const protocol::Field& field, std::string_view text) {
  const auto lower = [](std::string_view word) {
    std::string out{word};
    for (char& c : out)
      if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return out;
  };
  std::vector<std::string> names;
  for (const auto& value : field.values) names.push_back(lower(value.name));
  const std::string word = lower(text);
  const std::string_view found = nearest(word, names);
  for (std::size_t i = 0; i < names.size() && !found.empty(); ++i)
    if (names[i] == found) return "did you mean " + quoted(field.values[i].name) + "? ";
  return {};
}

/// What a float's text says, with the field's unit or without: the nearest double, or NaN, Infinity.
[[nodiscard]] inline base::Result<double> parse_float(const protocol::Field& field, std::string_view text) {
  if (!field.unit.empty() && text.ends_with(field.unit)) text.remove_suffix(field.unit.size());
  while (text.ends_with(' ')) text.remove_suffix(1);
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc::result_out_of_range) return base::Error::out_of_range;
  if (error != std::errc{} || end != text.data() + text.size()) return base::Error::bad_syntax;
  return value;
}

/// An integer's text, with the field's unit or without, where its digits are too many for a Decimal.
[[nodiscard]] inline base::Result<std::int64_t> parse_wide(const protocol::Field& field,
                                                           std::string_view text) {
  if (!field.unit.empty() && text.ends_with(field.unit)) text.remove_suffix(field.unit.size());
  while (text.ends_with(' ')) text.remove_suffix(1);
  return field.is_float() ? base::Result<std::int64_t>{base::Error::bad_syntax} : wide_raw_from(field, text);
}

/// A number with a unit. The field's own is taken off first: one such as 1/min begins like a number.
[[nodiscard]] inline base::Result<Quantity> quantity_for(const protocol::Field& field,
                                                         std::string_view text) {
  if (!field.unit.empty() && text.ends_with(field.unit))
    if (const auto number = base::parse_decimal(text.substr(0, text.size() - field.unit.size())))
      return Quantity{*number, field.unit};
  return parse_quantity(text);
}

/// Whether it begins as a hexadecimal number does.
[[nodiscard]] inline bool is_hexadecimal(std::string_view text) {
  return text.starts_with("0x") || text.starts_with("0X");
}
/// "34" of "0x22", with the digits of any number of 64 bits; nothing of what is no hexadecimal number.
[[nodiscard]] inline std::optional<std::string> decimal_of_hexadecimal(std::string_view text) {
  if (!is_hexadecimal(text)) return std::nullopt;
  const auto number = base::parse_unsigned(text.substr(2), 16);
  return number ? std::optional{std::to_string(*number)} : std::nullopt;
}

/// The value of this name. None for a number in the field's unit that the field can be: 2 means 2, although
/// many files call 1 "2". With a blank it is a name.
[[nodiscard]] inline std::optional<std::int64_t> named_raw(const protocol::Field& field,
                                                           std::string_view text) {
  if (field.flags) return std::nullopt;
  for (const auto& value : field.values) {
    if (value.name != text) continue;
    if (text.find(' ') != std::string_view::npos) return value.raw;
    const auto quantity = quantity_for(field, text);
    const bool is_own = quantity && (quantity->unit.empty() || quantity->unit == field.unit);
    if (is_own && (field.is_float() || field.raw_from(quantity->number).ok())) return std::nullopt;
    return value.raw;
  }
  return std::nullopt;
}

/// Whether it is a count or a code, of which there are no fractions.
[[nodiscard]] inline bool is_whole(const protocol::Field& field) {
  return !field.is_float() && field.unit.empty() && field.scale == base::Decimal{1, 0} &&
         field.offset.exponent >= 0;
}

[[nodiscard]] inline bool is_fraction(const protocol::Field& field, const base::Decimal& number) {
  return is_whole(field) && base::normalised(number.digits, number.exponent).exponent < 0;
}

}  // namespace detail

/// A number for a field, from "0.05m/s", "12" (in the field's unit), "0x0C" (the same) or the name of a value
/// that is no such number. The error is said in words, with the field's unit and range.
[[nodiscard]] inline base::Result<std::int64_t, std::string> parse_value(const protocol::Field& field,
                                                                         std::string_view text) {
  if (const auto named = detail::named_raw(field, text)) return *named;
  if (const auto decimal = detail::decimal_of_hexadecimal(text)) return parse_value(field, *decimal);
  if (detail::is_hexadecimal(text))
    return detail::quoted(text) + " is no hexadecimal number of 64 bits: " + detail::takes(field);
  if (field.is_float()) {
    const auto value = detail::parse_float(field, text);
    const auto bits = value ? field.float_from(*value) : base::Result<std::int64_t>{value.error};
    if (bits) return *bits;
    // A number in another unit goes on below.
    if (bits.error == base::Error::out_of_range)
      return detail::quoted(text) + " is out of range: " + detail::takes(field);
  }
  const auto quantity = detail::quantity_for(field, text);
  if (!quantity || !field.raw_from(quantity->number))
    if (const auto wide = detail::parse_wide(field, text)) return *wide;
  if (!quantity) {
    const bool has_names = !field.values.empty() && !field.flags;
    return detail::quoted(text) + (has_names ? " has no meaning: " : " is not a number: ") +
           (has_names ? detail::near_name(field, text) : std::string{}) + detail::takes(field);
  }
  if (!quantity->unit.empty() && field.unit.empty())
    return detail::quoted(text) + " has a unit, but " + std::string{field.name} +
           " is a plain number: " + detail::takes(field);
  const auto physical = convert(*quantity, field.unit);
  if (physical.error == base::Error::bad_unit)
    return detail::quoted(text) + " is in another unit: " + detail::takes(field);
  const auto raw = !physical          ? base::Result<std::int64_t>{physical.error}
                   : field.is_float() ? field.float_from(physical->as_double())
                                      : field.raw_from(*physical);
  if (!raw) return detail::quoted(text) + " is out of range: " + detail::takes(field);
  if (detail::is_fraction(field, *physical))
    return detail::quoted(text) + " is no whole number: " + detail::takes(field);
  return *raw;
}

/// As parse_value, for what people type: where the field has a unit, so has the number. 500 may be meant in
/// the field's metres a second or in the wire's micrometres, and a robot must not find out which. Zero is the
/// same in all units that have no offset. [docs/decisions/0027]
[[nodiscard]] inline base::Result<std::int64_t, std::string> parse_typed_value(const protocol::Field& field,
                                                                               std::string_view text) {
  if (const auto decimal = detail::decimal_of_hexadecimal(text); decimal && !detail::named_raw(field, text))
    return parse_typed_value(field, *decimal);
  const auto quantity = detail::quantity_for(field, text);
  if (quantity && quantity->unit.empty() && !field.unit.empty() &&
      (quantity->number.digits != 0 || field.offset.digits != 0))
    return detail::quoted(text) + " needs a unit: " + detail::takes(field);
  return parse_value(field, text);
}

/// The value that was written as a number and, as the next word, its unit; empty: the field does not take it.
[[nodiscard]] inline std::string written_apart(const protocol::Field& field, std::string_view number,
                                               std::string_view unit) {
  std::string whole = as_one_word(number, unit);
  return !whole.empty() && parse_typed_value(field, whole) ? std::move(whole) : std::string{};
}

}  // namespace ocm::cli::words
