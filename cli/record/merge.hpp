/// Frames of several buses in the order of their times. Each bus is in order by itself, but they are read one
/// after the other: what came to the first while the second was read is found one round later. So nothing
/// leaves before one more round has passed. O(n log n) in the frames of two rounds.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/log/entry.hpp"

namespace ocm::cli::record {

class Merge {
 public:
  void add(std::span<const log::Entry> entries) {
    waiting_.insert(waiting_.end(), entries.begin(), entries.end());
  }
  /// Ends a round: the frames that no later round can precede, in order. Valid until the next call.
  [[nodiscard]] std::span<const log::Entry> take() { return take_until(newest_of_last_round_); }
  /// All that is left.
  [[nodiscard]] std::span<const log::Entry> take_all() { return take_until(base::never); }

 private:
  std::span<const log::Entry> take_until(base::Time last) {
    const auto earlier = [](const log::Entry& a, const log::Entry& b) { return a.time < b.time; };
    std::stable_sort(waiting_.begin(), waiting_.end(), earlier);
    const auto end = std::find_if(waiting_.begin(), waiting_.end(),
                                  [last](const log::Entry& entry) { return entry.time > last; });
    taken_.assign(waiting_.begin(), end);
    waiting_.erase(waiting_.begin(), end);
    newest_of_last_round_ = waiting_.empty() ? base::Time::min() : waiting_.back().time;
    return taken_;
  }

  std::vector<log::Entry> waiting_;
  std::vector<log::Entry> taken_;
  base::Time newest_of_last_round_ = base::Time::min();
};

}  // namespace ocm::cli::record
