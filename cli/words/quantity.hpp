/// Numbers with units as a person writes them: 500ms, 5cm/s, -30deg/s. Exact where the conversion is a power
/// of ten.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

#include "ocm/base/decimal.hpp"
#include "ocm/base/result.hpp"
#include "ocm/base/text.hpp"
#include "ocm/base/time.hpp"
#include "ocm/protocol/request.hpp"

namespace ocm::cli::words {

/// A number and the unit written behind it; the unit is empty for a bare number.
struct Quantity {
  base::Decimal number;
  std::string_view unit;
};

/// Splits "5cm/s" into 5 and "cm/s". The unit is not looked at.
[[nodiscard]] constexpr base::Result<Quantity> parse_quantity(std::string_view text) noexcept {
  std::size_t end = 0;
  if (end < text.size() && (text[end] == '-' || text[end] == '+')) ++end;
  while (end < text.size() && (base::is_digit(text[end]) || text[end] == '.')) ++end;
  // An exponent only where digits follow, so that "1e" stays a number with a unit.
  if (end < text.size() && (text[end] == 'e' || text[end] == 'E')) {
    std::size_t exponent = end + 1;
    if (exponent < text.size() && (text[exponent] == '-' || text[exponent] == '+')) ++exponent;
    if (exponent < text.size() && base::is_digit(text[exponent])) {
      end = exponent;
      while (end < text.size() && base::is_digit(text[end])) ++end;
    }
  }
  const auto number = base::parse_decimal(text.substr(0, end));
  if (!number) return number.error;
  return Quantity{*number, text.substr(end)};
}

namespace detail {
/// A unit as prefix (power of ten), base unit, and whether it is per second.
struct Unit {
  int exponent = 0;
  std::string_view base;
  bool per_second = false;
};

[[nodiscard]] constexpr base::Result<Unit> parse_unit(std::string_view text) noexcept {
  Unit unit;
  if (text.size() > 2 && text.substr(text.size() - 2) == "/s") {
    unit.per_second = true;
    text.remove_suffix(2);
  }
  constexpr std::string_view bases[] = {"m", "rad", "deg", "g", "G", "W", "s", "V", "A", "%", "min"};
  for (const auto base : bases)
    if (text == base) {
      unit.base = base;
      return unit;
    }
  struct Prefix {
    std::string_view text;
    int exponent;
  };
  // The micro sign and the Greek letter look the same and are both typed.
  constexpr Prefix prefixes[] = {{"n", -9}, {"u", -6}, {"\u00b5", -6}, {"\u03bc", -6},
                                 {"m", -3}, {"c", -2}, {"d", -1},      {"k", 3}};
  for (const auto& prefix : prefixes) {
    if (!text.starts_with(prefix.text)) continue;
    for (const auto base : bases)
      if (text.substr(prefix.text.size()) == base) {
        unit.exponent = prefix.exponent;
        unit.base = base;
        return unit;
      }
  }
  return base::Error::bad_unit;
}
}  // namespace detail

/// `quantity` in `unit`. A bare number is taken to be in `unit` already. bad_unit: no such unit, or of
/// another kind.
[[nodiscard]] inline base::Result<base::Decimal> convert(const Quantity& quantity, std::string_view unit) {
  if (quantity.unit.empty() || quantity.unit == unit) return quantity.number;
  const auto from = detail::parse_unit(quantity.unit);
  const auto to = detail::parse_unit(unit);
  if (!from || !to || from->per_second != to->per_second) return base::Error::bad_unit;
  const int shift = from->exponent - to->exponent;
  if (from->base == to->base) return base::multiply(quantity.number, {1, static_cast<std::int8_t>(shift)});

  constexpr double degrees = 180 / 3.14159265358979323846;
  double factor = 0;
  if (from->base == "deg" && to->base == "rad") factor = 1 / degrees;
  if (from->base == "rad" && to->base == "deg") factor = degrees;
  if (factor == 0) return base::Error::bad_unit;
  // No decimal is exact here; a billionth of the unit is far below what any field resolves.
  const double scaled = quantity.number.as_double() * factor * std::pow(10.0, shift) * 1e9;
  if (!(std::abs(scaled) < 9e18)) return base::Error::out_of_range;
  return base::normalised(std::llround(scaled), -9);
}

/// "500ms", "2s", "1.5s", "900us", "1min", "1h". bad_unit: no unit or another one; out_of_range: over 292
/// years or finer than a nanosecond.
[[nodiscard]] constexpr base::Result<base::Duration> parse_duration(std::string_view text) noexcept {
  const auto quantity = parse_quantity(text);
  if (!quantity) return quantity.error;
  struct Unit {
    std::string_view name;
    std::int64_t nanoseconds;
  };
  constexpr Unit units[] = {
      {"ns", 1},         {"us", 1'000},        {"\u00b5s", 1'000},      {"\u03bcs", 1'000},
      {"ms", 1'000'000}, {"s", 1'000'000'000}, {"min", 60'000'000'000}, {"h", 3'600'000'000'000}};
  for (const auto& unit : units) {
    if (quantity->unit != unit.name) continue;
    // Normalised, so that powers of ten go into the exponent: every duration that is printed can be read.
    const auto ns = base::multiply(quantity->number, base::normalised(unit.nanoseconds, 0));
    if (!ns || ns->exponent < 0) return base::Error::out_of_range;
    const auto count = base::detail::scaled(ns->digits, ns->exponent);
    if (!count) return count.error;
    return base::Duration{*count};
  }
  return base::Error::bad_unit;
}

/// In the largest unit that is exact up to three places: 1.5s, 500ms, 900us, 10ns.
[[nodiscard]] inline std::string to_text(base::Duration duration) {
  const std::int64_t ns = duration.count();
  if (ns == 0) return "0s";
  struct Unit {
    std::string_view name;
    int exponent;
    std::int64_t finest;
  };
  constexpr Unit units[] = {{"s", -9, 1'000'000}, {"ms", -6, 1'000}, {"us", -3, 1}, {"ns", 0, 1}};
  for (const auto& unit : units) {
    const bool large_enough = ns / (unit.finest * 1000) != 0 || unit.exponent == 0;
    if (ns % unit.finest == 0 && large_enough)
      return std::string{base::to_text(base::normalised(ns, unit.exponent)).view()} + std::string{unit.name};
  }
  return {};
}

[[nodiscard]] inline std::string to_text(protocol::Period period) {
  return to_text(period.duration());
}

}  // namespace ocm::cli::words
