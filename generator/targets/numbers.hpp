/// Raw numbers as the text of a file that a reader makes the same numbers of.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "generator/spec/model.hpp"

namespace ocm::generate {

/// The shortest that gives the same number back; a whole number as its digits.
template <class Float>
[[nodiscard]] std::string shortest(Float value) {
  char text[40];
  for (int digits = 1; digits <= 17; ++digits) {
    std::snprintf(text, sizeof text, "%.*g", digits, static_cast<double>(value));
    if (static_cast<Float>(std::strtod(text, nullptr)) == value) break;
  }
  return text;
}

/// FieldModel::start, which must be there: FieldModel::start_from makes it of this number again.
[[nodiscard]] inline std::string start_text(const spec::FieldModel& field) {
  const std::int64_t raw = *field.start;
  if (field.number == protocol::Number::float32)
    return shortest(std::bit_cast<float>(static_cast<std::uint32_t>(raw)));
  if (field.number == protocol::Number::float64) return shortest(std::bit_cast<double>(raw));
  return field.raw_text(raw);
}

}  // namespace ocm::generate
