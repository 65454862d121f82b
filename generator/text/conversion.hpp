/// Between raw numbers and physical values in generated code: physical = (raw * factor + shift) / divisor,
/// all whole numbers, so that it is rounded once where raw * factor stays below 2^53.
#pragma once

#include <string>

#include "generator/spec/model.hpp"

namespace ocm::generate {

/// Literals of doubles, with ' between thousands.
struct Conversion {
  std::string factor;   ///< empty: 1
  std::string shift;    ///< empty: 0; with its sign
  std::string divisor;  ///< empty: 1
};
[[nodiscard]] Conversion conversion(const spec::FieldModel& field);

/// An expression for the physical value of the raw number `text`.
[[nodiscard]] std::string to_physical(const Conversion& conversion, std::string text);
/// An expression for the raw number, not yet rounded, of the physical value `text`.
[[nodiscard]] std::string to_raw(const Conversion& conversion, std::string text);

}  // namespace ocm::generate
