/// The last value of a range that still passes.
#pragma once

#include <cstdint>
#include <optional>

#include "ocm/analysis/sensitivity.hpp"

namespace ocm::cli::analyse {

/// What one of thousands of tests may cost.
inline constexpr analysis::Limits quick{.terms = 200'000};

/// From `good` on towards `bad`, both included; none if `good` does not pass. Whatever is farther than one
/// that does not pass, does not pass either. At most 62 tests.
template <class Passes>
std::optional<std::int64_t> last_good(std::int64_t good, std::int64_t bad, Passes passes) {
  if (!passes(good)) return std::nullopt;
  if (passes(bad)) return bad;
  while (bad - good > 1 || good - bad > 1) {
    const std::int64_t middle = good + (bad - good) / 2;
    (passes(middle) ? good : bad) = middle;
  }
  return good;
}

}  // namespace ocm::cli::analyse
