/// What to say of a mistyped word: the known one that it was probably meant to be, or all that there are.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "generator/spec/edit_distance.hpp"

namespace ocm::cli::words {

namespace detail {
[[nodiscard]] inline std::size_t common_prefix(std::string_view a, std::string_view b) {
  return static_cast<std::size_t>(
      std::mismatch(a.begin(), a.begin() + static_cast<std::ptrdiff_t>(std::min(a.size(), b.size())),
                    b.begin())
          .first -
      a.begin());
}
[[nodiscard]] inline bool is_same_but_case(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [&](char x, char y) { return lower(x) == lower(y); });
}
}  // namespace detail

/// The candidate that differs in case only; else that which is fewest edits away: one in a short word, two in
/// a longer one; of equally near ones that which begins alike for longer. Else the only one of which the word
/// is the beginning, --dry-run of --dry. Empty: none.
[[nodiscard]] inline std::string_view nearest(std::string_view word,
                                              std::span<const std::string_view> candidates) {
  for (const auto candidate : candidates)
    if (detail::is_same_but_case(word, candidate)) return candidate;
  std::string_view found;
  std::size_t least = word.size() < 6 ? 1 : 2;
  for (const auto candidate : candidates) {
    const std::size_t distance = spec::edit_distance(word, candidate, least);
    if (distance > least) continue;
    if (!found.empty() && distance == least &&
        detail::common_prefix(word, candidate) <= detail::common_prefix(word, found))
      continue;
    least = distance;
    found = candidate;
  }
  if (!found.empty() || word.size() < 3) return found;
  for (const auto candidate : candidates) {
    if (!candidate.starts_with(word)) continue;
    if (!found.empty()) return {};
    found = candidate;
  }
  return found;
}

/// The same of texts in any container.
template <class Texts>
requires(!std::convertible_to<const Texts&, std::span<const std::string_view>>) [[nodiscard]] std::string_view
    nearest(std::string_view word, const Texts& texts) {
  return nearest(word, std::vector<std::string_view>(texts.begin(), texts.end()));
}

/// "one of: a, b, c"
[[nodiscard]] inline std::string one_of(std::span<const std::string_view> candidates) {
  std::string all = "one of: ";
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (i != 0) all += ", ";
    all += candidates[i];
  }
  return all;
}

/// "did you mean 'gyro'?" or, when nothing is near, "one of: a, b, c".
[[nodiscard]] inline std::string suggestion(std::string_view word,
                                            std::span<const std::string_view> candidates) {
  const auto found = nearest(word, candidates);
  return found.empty() ? one_of(candidates) : "did you mean '" + std::string{found} + "'?";
}

}  // namespace ocm::cli::words
