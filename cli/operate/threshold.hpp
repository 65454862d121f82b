/// A condition as people type it, `ring.sensor_4>3000`, as one on raw numbers: which of them fulfil it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "ocm/base/result.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/reflective/operator.hpp"

#include "cli/words/condition.hpp"

namespace ocm::cli::operate {

struct Threshold {
  reflective::Is is = reflective::Is::above;
  std::int64_t limit = 0;  ///< as reflective::Condition has it
  bool negated = false;    ///< not: `is`
};

namespace detail {

/// The raw number whose `reflective::ordered` is this.
[[nodiscard]] constexpr std::int64_t raw_of(const protocol::Field& field, std::int64_t ordered) noexcept {
  if (field.number == protocol::Number::float32) {
    const auto bits = static_cast<std::int32_t>(ordered < 0 ? std::int64_t{INT32_MIN} - ordered : ordered);
    return std::int64_t{static_cast<std::uint32_t>(bits)};
  }
  if (field.number == protocol::Number::float64) return ordered < 0 ? INT64_MIN - ordered : ordered;
  return reflective::ordered(field, ordered);  // the same again for integers
}

struct Bounds {
  std::int64_t least;
  std::int64_t most;
};
/// Of `ordered`, NaNs apart.
[[nodiscard]] constexpr Bounds bounds_of(const protocol::Field& field) noexcept {
  if (field.number == protocol::Number::float32)
    return {std::int64_t{INT32_MIN} - INT32_C(-8388608), 0x7F80'0000};
  if (field.number == protocol::Number::float64)
    return {INT64_MIN - INT64_C(-4503599627370496), 0x7FF0'0000'0000'0000};
  const unsigned width = field.position.width;
  if (width == 64) return {INT64_MIN, INT64_MAX};
  const std::int64_t half = std::int64_t{1} << (width - 1);
  return field.is_signed ? Bounds{-half, half - 1} : Bounds{0, 2 * half - 1};
}

}  // namespace detail

/// Which raw numbers fulfil a condition. The error says in words why it is the same for all of them, or for
/// none but by chance.
[[nodiscard]] inline base::Result<Threshold, std::string> threshold(const protocol::Field& field,
                                                                    words::Comparison comparison,
                                                                    std::string_view value) {
  using words::Comparison;
  const auto condition = words::Condition::of(field, comparison, value);
  if (!condition) return condition.error;
  const bool equality = comparison == Comparison::equal || comparison == Comparison::different;
  if (field.flags)
    for (const auto& named : field.values)
      if (named.name == value)
        return Threshold{reflective::Is::any_bit,
                         static_cast<std::int64_t>(std::uint64_t{1} << static_cast<unsigned>(named.raw)),
                         comparison == Comparison::different};
  if (equality && field.is_float()) return std::string{"two floats are hardly ever equal: write < or >"};

  // Conditions with an order hold from some number on, or up to one.
  const auto [least, most] = detail::bounds_of(field);
  const auto from = equality ? words::Condition::of(field, Comparison::at_least, value) : condition;
  if (!from) return from.error;
  const auto holds = [&](std::int64_t ordered) { return from->holds(detail::raw_of(field, ordered)); };
  const bool first = holds(least);
  const bool constant = first == holds(most);
  if (constant && !equality)
    return std::string{"it is the same for all values: "} + words::detail::takes(field);
  std::int64_t same = least;  // as the least, and the next one that is not
  std::int64_t other = most;
  while (!constant && static_cast<std::uint64_t>(other) - static_cast<std::uint64_t>(same) > 1) {
    const auto half = (static_cast<std::uint64_t>(other) - static_cast<std::uint64_t>(same)) / 2;
    const auto middle = static_cast<std::int64_t>(static_cast<std::uint64_t>(same) + half);
    (holds(middle) == first ? same : other) = middle;
  }
  if (!equality)
    return first ? Threshold{reflective::Is::below, other, false}
                 : Threshold{reflective::Is::above, same, false};
  const auto equal = words::Condition::of(field, Comparison::equal, value);
  for (const std::int64_t ordered : {same, other}) {
    const std::int64_t raw = detail::raw_of(field, ordered);
    if (equal && equal->holds(raw))
      return Threshold{comparison == Comparison::equal ? reflective::Is::equal : reflective::Is::other, raw,
                       false};
  }
  return std::string{"no value is equal to it: "} + words::detail::takes(field);
}

}  // namespace ocm::cli::operate
