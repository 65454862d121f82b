/// How much of a processor or of a bus is asked for, exactly, and the two tests that need no more than that:
/// n(2^(1/n) - 1) [Liu, Layland 1973] and the product of all U + 1 [Bini, Buttazzo, Buttazzo 2003].
///
/// No floating point: a sum is a reduced fraction while 63 bits hold it, and always two numbers of 62 binary
/// digits that have the truth between them. What neither can decide is said to be undecided, and is never
/// taken for proven. Cost: O(n) divisions and greatest common divisors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <string_view>

#include "ocm/analysis/checked.hpp"
#include "ocm/analysis/task_set.hpp"
#include "ocm/analysis/verdict.hpp"

namespace ocm::analysis {

namespace detail {

/// Binary digits after the point: numbers from 0 to under 4 in 64 bits, of which the greatest means "or
/// more".
inline constexpr unsigned point = 62;
inline constexpr std::uint64_t one = std::uint64_t{1} << point;
inline constexpr std::uint64_t beyond = std::numeric_limits<std::uint64_t>::max();

/// A number that lies in [low, high].
struct Between {
  std::uint64_t low = 0;
  std::uint64_t high = 0;
};

constexpr std::uint64_t add(std::uint64_t a, std::uint64_t b) noexcept {
  return a > beyond - b ? beyond : a + b;
}

/// part / whole, for 0 <= part < whole.
constexpr Between fraction_of(std::int64_t part, std::int64_t whole) noexcept {
  auto rest = static_cast<std::uint64_t>(part);
  const auto divisor = static_cast<std::uint64_t>(whole);
  std::uint64_t digits = 0;
  const unsigned step = divisor >> 33U == 0 ? 31 : 1;  // so that the shifted rest fits
  for (unsigned done = 0; done < point; done += step) {
    rest <<= step;
    digits = digits << step | rest / divisor;
    rest %= divisor;
  }
  return {digits, digits + (rest == 0 ? 0U : 1U)};
}

/// a * b, rounded down or up.
constexpr std::uint64_t multiply(std::uint64_t a, std::uint64_t b, bool up) noexcept {
  constexpr std::uint64_t half = 0xFFFF'FFFF;
  if (a == beyond || b == beyond) return beyond;
  const std::uint64_t low = (a & half) * (b & half);
  const std::uint64_t middle = (a >> 32U) * (b & half) + (low >> 32U);
  const std::uint64_t other = (a & half) * (b >> 32U) + (middle & half);
  const std::uint64_t high = (a >> 32U) * (b >> 32U) + (middle >> 32U) + (other >> 32U);
  const std::uint64_t lower = (other << 32U) | (low & half);
  if (high >> point != 0) return beyond;
  const std::uint64_t result = high << (64 - point) | lower >> point;
  return up && (lower & (one - 1)) != 0 ? add(result, 1) : result;
}
constexpr Between multiply(Between a, Between b) noexcept {
  return {multiply(a.low, b.low, false), multiply(a.high, b.high, true)};
}

/// A non-negative fraction in lowest terms, while 63 bits hold it.
class Fraction {
 public:
  constexpr Fraction() = default;
  constexpr Fraction(Checked numerator, Checked denominator) noexcept { set(numerator, denominator); }
  [[nodiscard]] constexpr bool ok() const noexcept { return denominator_ != 0; }
  [[nodiscard]] constexpr std::int64_t numerator() const noexcept { return numerator_; }
  [[nodiscard]] constexpr std::int64_t denominator() const noexcept { return denominator_; }  ///< 0: unknown

  constexpr void add(std::int64_t numerator, std::int64_t denominator) noexcept {
    if (!ok()) return;
    const Checked common = Checked{denominator_ / std::gcd(denominator_, denominator)} * denominator;
    if (!common.ok()) return set(common, common);
    set(Checked{numerator_} * (common.value() / denominator_) +
            Checked{numerator} * (common.value() / denominator),
        common);
  }
  constexpr void multiply(std::int64_t numerator, std::int64_t denominator) noexcept {
    if (!ok()) return;
    const std::int64_t a = std::gcd(numerator, denominator_);
    const std::int64_t b = std::gcd(numerator_, denominator);
    set(Checked{numerator_ / b} * (numerator / a), Checked{denominator_ / a} * (denominator / b));
  }

 private:
  constexpr void set(Checked numerator, Checked denominator) noexcept {
    if (!numerator.ok() || !denominator.ok()) {
      denominator_ = 0;
      return;
    }
    const std::int64_t common = std::gcd(numerator.value(), denominator.value());
    numerator_ = numerator.value() / common;
    denominator_ = denominator.value() / common;
  }
  std::int64_t numerator_ = 0;
  std::int64_t denominator_ = 1;
};

}  // namespace detail

/// How a sum or product compares with a bound.
enum class Comparison : std::uint8_t { below, equal, above, undecided };

/// U, the sum of all C/T.
class Utilisation {
 public:
  /// cost >= 0, period >= 1: anything else spoils the sum.
  constexpr void add(std::int64_t cost, std::int64_t period) noexcept {
    if (cost < 0 || period < 1) valid_ = false;
    if (!valid_) return;
    exact_.add(cost, period);
    const detail::Between rest = detail::fraction_of(cost % period, period);
    low_.add(cost / period, rest.low);
    high_.add(cost / period, rest.high);
  }

  /// False: a cost or a period meant nothing.
  [[nodiscard]] constexpr bool valid() const noexcept { return valid_; }
  /// U = numerator / denominator, in lowest terms; denominator 0: 63 bits do not hold that.
  [[nodiscard]] constexpr std::int64_t numerator() const noexcept { return exact_.numerator(); }
  [[nodiscard]] constexpr std::int64_t denominator() const noexcept { return exact_.denominator(); }
  /// U in parts per million, rounded up (at most one too many where there is no fraction).
  [[nodiscard]] constexpr std::int64_t parts_per_million() const noexcept {
    constexpr std::int64_t million = 1'000'000;
    if (exact_.ok()) {
      const std::int64_t whole = exact_.numerator() / exact_.denominator();
      const Checked rest = Checked{exact_.numerator() % exact_.denominator()} * million;
      if (rest.ok())
        return (Checked{whole} * million + ceil_div(rest, exact_.denominator())).value_or(unbounded);
    }
    constexpr unsigned dropped = 20;  // so that a million times the rest fits
    const auto rest = static_cast<std::int64_t>((high_.rest >> dropped) + 1);
    return (Checked{high_.whole} * million +
            ceil_div(Checked{rest} * million, static_cast<std::int64_t>(detail::one >> dropped)))
        .value_or(unbounded);
  }
  /// With 1, exactly; undecided only where 63 bits hold no fraction and U is within n * 2^-62 of 1.
  [[nodiscard]] constexpr Comparison versus_one() const noexcept {
    if (!valid_) return Comparison::undecided;
    if (exact_.ok()) {
      if (exact_.numerator() == exact_.denominator()) return Comparison::equal;
      return exact_.numerator() < exact_.denominator() ? Comparison::below : Comparison::above;
    }
    if (high_.whole == 0) return Comparison::below;
    if (low_.whole > 1 || (low_.whole == 1 && low_.rest > 0)) return Comparison::above;
    return Comparison::undecided;
  }
  /// As a number of `detail`, which saturates at 4.
  [[nodiscard]] constexpr detail::Between between() const noexcept { return {low_.number(), high_.number()}; }

 private:
  struct Sum {
    std::int64_t whole = 0;
    std::uint64_t rest = 0;  // below one
    constexpr void add(std::int64_t more, std::uint64_t digits) noexcept {
      rest += digits;
      whole = (Checked{whole} + more + static_cast<std::int64_t>(rest >> detail::point)).value_or(unbounded);
      rest &= detail::one - 1;
    }
    [[nodiscard]] constexpr std::uint64_t number() const noexcept {
      return whole >= 4 ? detail::beyond : (static_cast<std::uint64_t>(whole) << detail::point | rest);
    }
  };
  detail::Fraction exact_;
  Sum low_;
  Sum high_;
  bool valid_ = true;
};

/// Of anything that has a cost and a period: tasks, messages.
template <class Items>
[[nodiscard]] constexpr Utilisation utilisation(const Items& items) noexcept {
  Utilisation sum;
  for (const auto& item : items) sum.add(item.cost, item.period);
  return sum;
}

/// What a test of the utilisation says. All are sufficient and none is necessary: not_proven is no miss.
enum class Proof : std::uint8_t {
  proven,              ///< every task meets its deadline
  not_proven,          ///< the bound is exceeded: response times tell (task_response.hpp)
  undecided,           ///< too close to the bound for 62 binary digits
  not_rate_monotonic,  ///< a task of a shorter period is not the more urgent one: the test does not apply
  not_simple,          ///< jitter, blocking or a deadline before the period: the test does not apply
  bad_input,           ///< an invalid number, or no task
};

[[nodiscard]] constexpr std::string_view describe(Proof proof) noexcept {
  switch (proof) {
    case Proof::proven:
      return "every task meets its deadline";
    case Proof::not_proven:
      return "beyond the bound, which proves nothing: see the response times";
    case Proof::undecided:
      return "too close to the bound to say";
    case Proof::not_rate_monotonic:
      return "does not apply: a task of a shorter period is not the more urgent one";
    case Proof::not_simple:
      return "does not apply: jitter, blocking, or a deadline before the period";
    case Proof::bad_input:
      return "an invalid number, or no task";
  }
  return "unknown";
}

namespace detail {

/// Whether the tests apply; not_proven: they do.
constexpr Proof applies(std::span<const Task> tasks) noexcept {
  if (tasks.empty() || first_invalid(tasks) != no_index) return Proof::bad_input;
  for (const Task& task : tasks) {
    if (task.due() < task.period || task.jitter > 0 || task.blocking > 0) return Proof::not_simple;
    for (const Task& other : tasks)
      if (task.period < other.period && task.level >= other.level) return Proof::not_rate_monotonic;
  }
  return Proof::not_proven;
}

/// (1 + load / count) ^ count, against 2.
constexpr Comparison layland_power(Between load, std::size_t count) noexcept {
  const auto n = static_cast<std::uint64_t>(count);
  const Between base{one + load.low / n, load.high == beyond ? beyond : one + load.high / n + 1};
  Between power{one, one};
  for (std::size_t i = 0; i < count && power.low <= 2 * one; ++i) power = multiply(power, base);
  if (power.high <= 2 * one) return Comparison::below;  // or equal
  return power.low > 2 * one ? Comparison::above : Comparison::undecided;
}

}  // namespace detail

/// n(2^(1/n) - 1) in parts per million, rounded down; 0 for no task. [Liu, Layland 1973]
[[nodiscard]] constexpr std::int64_t liu_layland_bound(std::size_t tasks) noexcept {
  if (tasks == 0) return 0;
  std::int64_t low = 0;
  std::int64_t high = 1'000'000;
  if (tasks == 1) return high;
  while (high - low > 1) {
    const std::int64_t middle = low + (high - low) / 2;
    const detail::Between load = detail::fraction_of(middle, 1'000'000);
    (detail::layland_power(load, tasks) == Comparison::below ? low : high) = middle;
  }
  return low;
}

/// U <= n(2^(1/n) - 1), compared as (1 + U/n)^n <= 2: no root is taken, so nothing is rounded.
[[nodiscard]] constexpr Proof liu_layland(std::span<const Task> tasks) noexcept {
  if (const Proof proof = detail::applies(tasks); proof != Proof::not_proven) return proof;
  const Utilisation load = utilisation(tasks);
  if (tasks.size() == 1) return load.versus_one() == Comparison::above ? Proof::not_proven : Proof::proven;
  switch (detail::layland_power(load.between(), tasks.size())) {  // never equal: the root is irrational
    case Comparison::below:
      return Proof::proven;
    case Comparison::above:
      return Proof::not_proven;
    default:
      return Proof::undecided;
  }
}

/// The product of all U + 1 is at most 2: proves all that liu_layland proves, and more.
[[nodiscard]] constexpr Proof hyperbolic(std::span<const Task> tasks) noexcept {
  if (const Proof proof = detail::applies(tasks); proof != Proof::not_proven) return proof;
  detail::Fraction exact{1, 1};
  detail::Between product{detail::one, detail::one};
  for (const Task& task : tasks) {
    if (task.cost > task.period) return Proof::not_proven;
    const Checked sum = Checked{task.cost} + task.period;
    if (sum.ok()) {
      exact.multiply(sum.value(), task.period);
    } else {
      exact = {sum, sum};
    }
    const bool full = task.cost == task.period;
    const detail::Between rest = full ? detail::Between{} : detail::fraction_of(task.cost, task.period);
    const std::uint64_t whole = full ? 2 * detail::one : detail::one;
    product = detail::multiply(product, {whole + rest.low, whole + rest.high});
  }
  // numerator <= 2 * denominator, without a product that may not fit
  if (exact.ok())
    return exact.numerator() / 2 + exact.numerator() % 2 <= exact.denominator() ? Proof::proven
                                                                                : Proof::not_proven;
  if (product.high <= 2 * detail::one) return Proof::proven;
  return product.low > 2 * detail::one ? Proof::not_proven : Proof::undecided;
}

}  // namespace ocm::analysis
