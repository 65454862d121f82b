/// Conditions and what is made of them with and, or, not: the steps of a monitor. Three values: what nothing
/// is known of yet is neither true nor false, and a monitor fires only on what is true (Kleene's logic).
///
/// Time O(terms); no heap; an expression has 64 operands waiting at most (check.hpp sees to it).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/base/time.hpp"
#include "ocm/reflective/operator.hpp"

namespace ocm::reflective {

enum class Truth : std::uint8_t { unknown, no, yes };

[[nodiscard]] constexpr Truth truth(bool value) noexcept {
  return value ? Truth::yes : Truth::no;
}
[[nodiscard]] constexpr Truth operator!(Truth a) noexcept {
  return a == Truth::unknown ? a : truth(a == Truth::no);
}
[[nodiscard]] constexpr Truth both(Truth a, Truth b) noexcept {
  if (a == Truth::no || b == Truth::no) return Truth::no;
  return a == Truth::unknown || b == Truth::unknown ? Truth::unknown : Truth::yes;
}
[[nodiscard]] constexpr Truth either(Truth a, Truth b) noexcept {
  return !both(!a, !b);
}

/// Whether a condition holds with this value, if it has been `before`.
[[nodiscard]] constexpr bool holds(const Condition& condition, std::int64_t value, bool before) noexcept {
  const bool timed = condition.watched == Watched::age || condition.watched == Watched::gap;
  const std::int64_t slack = before ? condition.hysteresis : 0;
  switch (condition.is) {
    case Is::above:
      return timed ? value >= condition.limit : value > condition.limit - slack;
    case Is::below:
      return value < condition.limit + slack;
    case Is::equal:
      return value == condition.limit;
    case Is::other:
      return value != condition.limit;
    case Is::any_bit:
      return (static_cast<std::uint64_t>(value) & static_cast<std::uint64_t>(condition.limit)) != 0;
  }
  return false;
}

inline constexpr std::size_t most_operands = 64;

/// An expression is whole when each operator has its operands and one value is left.
[[nodiscard]] constexpr bool well_formed(std::span<const Term> terms, std::size_t conditions) noexcept {
  std::size_t depth = 0;
  for (const Term& term : terms) {
    if (term.op == Op::condition) {
      if (term.condition >= conditions || ++depth > most_operands) return false;
    } else if (term.op == Op::negation) {
      if (depth < 1) return false;
    } else if (depth-- < 2) {
      return false;
    }
  }
  return depth == 1;
}

/// The value of an expression that is well formed; `of(condition)` gives the Truth of each.
template <class Of>
[[nodiscard]] constexpr Truth evaluate(std::span<const Term> terms, Of&& of) noexcept {
  // Two stacks of bits: which operands are true, and which are false.
  std::uint64_t yes = 0;
  std::uint64_t no = 0;
  for (const Term& term : terms) {
    if (term.op == Op::condition) {
      const Truth value = of(std::size_t{term.condition});
      yes = yes << 1U | (value == Truth::yes ? 1U : 0U);
      no = no << 1U | (value == Truth::no ? 1U : 0U);
    } else if (term.op == Op::negation) {
      const std::uint64_t different = (yes ^ no) & 1U;
      yes ^= different;
      no ^= different;
    } else {
      const bool all = term.op == Op::all;
      const std::uint64_t top_yes = all ? yes >> 1U & yes & 1U : (yes >> 1U | yes) & 1U;
      const std::uint64_t top_no = all ? (no >> 1U | no) & 1U : no >> 1U & no & 1U;
      yes = (yes >> 2U << 1U) | top_yes;
      no = (no >> 2U << 1U) | top_no;
    }
  }
  return (yes & 1U) != 0 ? Truth::yes : (no & 1U) != 0 ? Truth::no : Truth::unknown;
}

/// Whether the condition that term `index` of a well-formed expression stands for counts inverted: it is an
/// operand of an odd number of negations.
[[nodiscard]] constexpr bool negated(std::span<const Term> terms, std::size_t index) noexcept {
  bool odd = false;
  std::size_t above = 0;  // operands that wait above the one that contains it
  for (const Term& term : terms.subspan(index + 1)) {
    if (term.op == Op::condition)
      ++above;
    else if (term.op == Op::negation)
      odd ^= above == 0;
    else if (above > 0)
      --above;
  }
  return odd;
}

/// Since when an expression has been true without a break.
class Since {
 public:
  constexpr void take(Truth value, base::Time now) noexcept {
    if (value != Truth::yes)
      since_ = base::never;
    else if (since_ == base::never)
      since_ = now;
  }
  /// When it will have lasted long enough, if it lasts; never: it is not true now.
  [[nodiscard]] constexpr base::Time fires_at(base::Duration lasting) const noexcept {
    return since_ == base::never ? base::never : since_ + lasting;
  }

 private:
  base::Time since_ = base::never;
};

}  // namespace ocm::reflective
