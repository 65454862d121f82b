/// Numbers with units as a person writes them: 500ms, 5cm/s, -30deg/s, 3krpm.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
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

/// Splits "5cm/s", or "5 cm/s" as it is printed, into 5 and "cm/s". The unit is not looked at.
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
  if (end + 1 < text.size() && text[end] == ' ') ++end;
  return Quantity{*number, text.substr(end)};
}

namespace detail {
/// A unit as so many of a basic one, and the seconds that it is per (0: it is of no time).
struct Unit {
  base::Decimal factor{1, 0};
  std::string_view base;
  std::int32_t per = 0;
};
struct NamedUnit {
  std::string_view name;
  Unit unit;
  bool takes_prefix = true;
};

/// Not here: temperatures, whose zeros differ. `G` is gauss, `g` the acceleration of free fall.
constexpr NamedUnit named_units[] = {
    {"m", {{1, 0}, "m"}},
    {"rad", {{1, 0}, "rad"}},
    {"deg", {{1, 0}, "deg"}},
    {"\u00b0", {{1, 0}, "deg"}, false},  // the degree sign
    {"g", {{1, 0}, "g"}},
    {"G", {{1, 0}, "G"}},
    {"W", {{1, 0}, "W"}},
    {"s", {{1, 0}, "s"}},
    {"min", {{60, 0}, "s"}, false},
    {"h", {{3600, 0}, "s"}, false},
    {"V", {{1, 0}, "V"}},
    {"A", {{1, 0}, "A"}},
    {"Ah", {{1, 0}, "Ah"}},
    {"Wh", {{1, 0}, "Wh"}},
    {"Hz", {{1, 0}, "Hz"}},
    {"N", {{1, 0}, "N"}},
    {"Nm", {{1, 0}, "Nm"}},
    {"Pa", {{1, 0}, "Pa"}},
    {"bar", {{1, 5}, "Pa"}},
    {"l", {{1, 0}, "l"}},
    {"L", {{1, 0}, "l"}},
    {"%", {{1, 0}, "%"}},
    {"rpm", {{1, 0}, "turn", 60}},
    {"1/min", {{1, 0}, "turn", 60}, false},
    {"U/min", {{1, 0}, "turn", 60}, false},
    {"kph", {{1, 3}, "m", 3600}, false},
    {"mph", {{1609344, -3}, "m", 3600}, false},
};

[[nodiscard]] constexpr base::Result<Unit> parse_unit(std::string_view text) noexcept {
  for (const NamedUnit& named : named_units)
    if (text == named.name) return named.unit;
  constexpr struct {
    std::string_view ending;
    std::int32_t seconds;
  } times[] = {{"/s", 1}, {"/min", 60}, {"/h", 3600}};
  for (const auto& time : times) {
    if (!text.ends_with(time.ending)) continue;
    auto unit = parse_unit(text.substr(0, text.size() - time.ending.size()));
    if (unit && unit->per != 0) return base::Error::bad_unit;
    if (unit) unit->per = time.seconds;
    return unit;
  }
  constexpr struct {
    std::string_view text;
    int exponent;
  } prefixes[] = {{"n", -9}, {"u", -6}, {"\u00b5", -6}, {"\u03bc", -6},  // both are typed, and look the same
                  {"m", -3}, {"c", -2}, {"d", -1},      {"h", 2},       {"k", 3}, {"M", 6}};
  for (const auto& prefix : prefixes) {
    if (!text.starts_with(prefix.text)) continue;
    for (const NamedUnit& named : named_units)
      if (named.takes_prefix && text.substr(prefix.text.size()) == named.name) {
        Unit unit = named.unit;
        unit.factor.exponent = static_cast<std::int8_t>(unit.factor.exponent + prefix.exponent);
        return unit;
      }
  }
  return base::Error::bad_unit;
}

/// number * above / below; to a billionth where that has no end in decimals.
[[nodiscard]] inline base::Result<base::Decimal> scaled_by(const base::Decimal& number, base::Decimal above,
                                                           base::Decimal below) noexcept {
  auto product = base::multiply(number, {above.digits, static_cast<std::int8_t>(above.exponent)});
  if (!product) return product.error;
  for (int places = 0; places <= 9; ++places) {
    if (product->digits % below.digits == 0) {
      const base::Decimal quotient{product->digits / below.digits, product->exponent};
      return base::multiply(quotient, {1, static_cast<std::int8_t>(-below.exponent)});
    }
    if (__builtin_mul_overflow(product->digits, std::int64_t{10}, &product->digits)) break;
    product->exponent = static_cast<std::int8_t>(product->exponent - 1);
  }
  const double scaled = number.as_double() * above.as_double() / below.as_double() * 1e9;
  if (!(std::abs(scaled) < 9e18)) return base::Error::out_of_range;
  return base::normalised(std::llround(scaled), -9);
}
}  // namespace detail

/// `quantity` in `unit`. A bare number is taken to be in `unit` already. Exact where the result has an end in
/// decimals, as from 3krpm to rpm and from m/s to km/h; otherwise to a billionth of the unit, far below what
/// any field resolves. bad_unit: no such unit, or of another kind.
[[nodiscard]] inline base::Result<base::Decimal> convert(const Quantity& quantity, std::string_view unit) {
  if (quantity.unit.empty() || quantity.unit == unit) return quantity.number;
  const auto from = detail::parse_unit(quantity.unit);
  const auto to = detail::parse_unit(unit);
  if (!from || !to || (from->per == 0) != (to->per == 0)) return base::Error::bad_unit;
  base::Decimal above{from->factor.digits, from->factor.exponent};
  base::Decimal below{to->factor.digits, to->factor.exponent};
  if (from->per != to->per) {
    above.digits *= to->per;
    below.digits *= from->per;
  }
  if (from->base == to->base) return detail::scaled_by(quantity.number, above, below);

  // No decimal is exact here: pi in 18 digits.
  constexpr base::Decimal pi{3'141'592'653'589'793'238, -18};
  constexpr base::Decimal half_a_turn{180, 0};
  const bool to_radians = from->base == "deg" && to->base == "rad";
  if (!to_radians && !(from->base == "rad" && to->base == "deg")) return base::Error::bad_unit;
  const double factor =
      to_radians ? pi.as_double() / half_a_turn.as_double() : half_a_turn.as_double() / pi.as_double();
  const double scaled = quantity.number.as_double() * factor * above.as_double() / below.as_double() * 1e9;
  if (!(std::abs(scaled) < 9e18)) return base::Error::out_of_range;
  return base::normalised(std::llround(scaled), -9);
}

namespace detail {
[[nodiscard]] constexpr base::Result<base::Decimal> nanoseconds_in(std::string_view text) noexcept {
  const auto quantity = parse_quantity(text);
  if (!quantity) return quantity.error;
  struct UnitOfTime {
    std::string_view name;
    std::int64_t nanoseconds;
  };
  constexpr UnitOfTime times[] = {
      {"ns", 1},         {"us", 1'000},        {"\u00b5s", 1'000},      {"\u03bcs", 1'000},
      {"ms", 1'000'000}, {"s", 1'000'000'000}, {"min", 60'000'000'000}, {"h", 3'600'000'000'000}};
  for (const auto& unit : times) {
    if (quantity->unit != unit.name) continue;
    // Normalised, so that powers of ten go into the exponent: every duration that is printed can be read.
    return base::multiply(quantity->number, base::normalised(unit.nanoseconds, 0));
  }
  return base::Error::bad_unit;
}
}  // namespace detail

/// "500ms", "2s", "1.5s", "900us", "1min", "1h". bad_unit: no unit or another one; out_of_range: over 292
/// years or finer than a nanosecond.
[[nodiscard]] constexpr base::Result<base::Duration> parse_duration(std::string_view text) noexcept {
  const auto ns = detail::nanoseconds_in(text);
  if (!ns) return ns.error;
  if (ns->exponent < 0) return base::Error::out_of_range;
  const auto count = base::detail::scaled(ns->digits, ns->exponent);
  if (!count) return count.error;
  return base::Duration{*count};
}

/// The same, rounded to nanoseconds.
[[nodiscard]] constexpr base::Result<base::Duration> nearest_duration(std::string_view text) noexcept {
  const auto ns = detail::nanoseconds_in(text);
  if (!ns) return ns.error;
  const auto count = base::divide_rounded(*ns, {1, 0});
  if (!count) return count.error;
  return base::Duration{*count};
}

/// Whether it is a quantity but for its unit.
[[nodiscard]] constexpr bool lacks_unit(std::string_view text) noexcept {
  const auto quantity = parse_quantity(text);
  return quantity && quantity->unit.empty();
}

/// A number and its unit as one word; empty: they are something else.
[[nodiscard]] inline std::string as_one_word(std::string_view number, std::string_view unit) {
  std::string whole = std::string{number} + std::string{unit};
  const auto quantity = parse_quantity(whole);
  return lacks_unit(number) && quantity && quantity->unit == unit ? std::move(whole) : std::string{};
}

/// "30cm", where a quantity was written as two words; empty: the second is no unit that is known.
[[nodiscard]] inline std::string written_apart(std::string_view number, std::string_view unit) {
  std::string whole = as_one_word(number, unit);
  return detail::parse_unit(unit) ? std::move(whole) : std::string{};
}

/// The same of a time or a speed alone: "500ms" or "5cm/s".
[[nodiscard]] inline std::string time_or_speed_apart(std::string_view number, std::string_view unit) {
  const auto of = detail::parse_unit(unit);
  return of && (of->base == "s" || of->per != 0) ? written_apart(number, unit) : std::string{};
}

/// `apart` of the first two of a line that it takes; empty: it takes none.
template <typename Words, typename Apart>
[[nodiscard]] std::string any_apart(const Words& words, Apart apart) {
  for (std::size_t i = 1; i < words.size(); ++i)
    if (std::string whole = apart(words[i - 1], words[i]); !whole.empty()) return whole;
  return {};
}

/// The period of "20Hz" or "1.5kHz", to a nanosecond; nothing where it is no rate, or one above 1 GHz.
[[nodiscard]] inline std::optional<base::Duration> period_of_rate(std::string_view text) {
  const auto quantity = parse_quantity(text);
  if (!quantity || (quantity->unit != "Hz" && quantity->unit != "kHz")) return std::nullopt;
  const double rate = quantity->number.as_double() * (quantity->unit == "kHz" ? 1e3 : 1);
  if (!(rate >= 1e-9 && rate <= 1e9)) return std::nullopt;
  return base::Duration{static_cast<std::int64_t>(1e9 / rate + 0.5)};
}

/// What `text` is in place of the time that was expected: `otherwise`, unless it is one but for its unit.
[[nodiscard]] inline std::string instead_of_time(std::string_view text, std::string_view otherwise) {
  return std::string{lacks_unit(text) ? "a time without a unit" : otherwise};
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
