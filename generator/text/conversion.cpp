#include "generator/text/conversion.hpp"

#include <algorithm>
#include <cstdint>

#include "generator/text/words.hpp"

namespace ocm::generate {

using base::Decimal;
using spec::FieldModel;

namespace {

std::string power_of_ten(int n) {
  if (n <= 9) {
    std::uint64_t power = 1;
    for (int i = 0; i < n; ++i) power *= 10;
    return grouped(power) + ".0";
  }
  return "1e" + std::to_string(n);
}

/// digits * 10^zeros as a double literal. It is exact up to 2^53.
std::string whole(std::int64_t digits, int zeros) {
  std::uint64_t magnitude =
      digits < 0 ? 0 - static_cast<std::uint64_t>(digits) : static_cast<std::uint64_t>(digits);
  for (; zeros > 0 && magnitude <= 99'999'999; --zeros) magnitude *= 10;
  const std::string text = (digits < 0 ? "-" : "") + grouped(magnitude);
  return zeros == 0 ? text + ".0" : text + "e" + std::to_string(zeros);
}

}  // namespace

Conversion conversion(const FieldModel& field) {
  const Decimal scale = field.scale;
  const Decimal offset = field.offset;
  Conversion c;
  const int lowest = offset.digits == 0 ? scale.exponent : std::min<int>(scale.exponent, offset.exponent);
  const int places = lowest < 0 ? -lowest : 0;
  if (offset.digits == 0 && scale.digits > 0 && places > 0 && places <= 18) {
    std::int64_t power = 1;
    for (int i = 0; i < places; ++i) power *= 10;
    if (power % scale.digits == 0) {  // one part in so many: 1/1024, 1/1'000'000
      const std::int64_t parts = power / scale.digits;
      c.divisor = grouped(static_cast<std::uint64_t>(parts)) + ".0";
      return c;
    }
  }
  if (scale.digits != 1 || scale.exponent + places != 0)
    c.factor = whole(scale.digits, scale.exponent + places);
  if (offset.digits != 0) c.shift = whole(offset.digits, offset.exponent + places);
  if (places != 0) c.divisor = power_of_ten(places);
  return c;
}

std::string to_physical(const Conversion& c, std::string text) {
  if (!c.factor.empty()) text += " * " + c.factor;
  if (!c.shift.empty()) {
    text += c.shift.front() == '-' ? " - " + c.shift.substr(1) : " + " + c.shift;
    if (!c.divisor.empty()) text = "(" + text + ")";
  }
  if (!c.divisor.empty()) text += " / " + c.divisor;
  return text;
}

std::string to_raw(const Conversion& c, std::string text) {
  if (!c.divisor.empty()) text += " * " + c.divisor;
  if (!c.shift.empty()) {
    text += c.shift.front() == '-' ? " + " + c.shift.substr(1) : " - " + c.shift;
    if (!c.factor.empty()) text = "(" + text + ")";
  }
  if (!c.factor.empty()) text += " / " + c.factor;
  return text;
}

}  // namespace ocm::generate
