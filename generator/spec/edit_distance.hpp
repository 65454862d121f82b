/// How far a mistyped word is from another one, to name the word that was probably meant.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>
#include <utility>

namespace ocm::spec {

/// Insertions, deletions, substitutions and exchanges of neighbours from one to the other, of their first 64
/// characters; `most + 1` where there are more than `most`. O(1) where their lengths say so, else at most
/// O(a * most).
[[nodiscard]] inline std::size_t edit_distance(std::string_view a, std::string_view b, std::size_t most) {
  constexpr std::size_t longest = 64;
  a = a.substr(0, longest);
  b = b.substr(0, longest);
  most = std::min(most, longest);
  const std::size_t too_many = most + 1;
  if (std::max(a.size(), b.size()) - std::min(a.size(), b.size()) > most) return too_many;
  // Cells that are further from the diagonal than `most` have more edits behind them.
  std::array<std::size_t, longest + 1> before{}, row{}, next{};
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  std::size_t least = 0, least_before = 0;  // of a row; an exchange goes back two rows
  for (std::size_t i = 1; i <= a.size(); ++i) {
    const std::size_t first = i > most ? i - most : 1;
    const std::size_t last = std::min(b.size(), i + most);
    next[first - 1] = i <= most ? i : too_many;
    if (last < longest) next[last + 1] = too_many;
    least_before = std::exchange(least, next[first - 1]);
    for (std::size_t j = first; j <= last; ++j) {
      const std::size_t substituted = row[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      next[j] = std::min({row[j] + 1, next[j - 1] + 1, substituted});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        next[j] = std::min(next[j], before[j - 2] + 1);
      least = std::min(least, next[j]);
    }
    if (least > most && least_before > most) return too_many;
    before.swap(row);
    row.swap(next);
  }
  return std::min(row[b.size()], too_many);
}

}  // namespace ocm::spec
