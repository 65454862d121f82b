/// Frames of several buses in the order of their times. Each bus is in order by itself, but they are read one
/// after the other: what came to the first while the second was read is found one round later. So nothing
/// leaves before one more round has passed. The frames of one bus stay in the order in which they came, also
/// where the clock was set back between two of them. O(buses) a frame.
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
    for (const log::Entry& entry : entries) {
      if (entry.interface >= buses_.size()) buses_.resize(entry.interface + std::size_t{1});
      buses_[entry.interface].entries.push_back(entry);
    }
  }
  /// Ends a round: the frames of the rounds before, and those that precede them, in order. Valid until the
  /// next call.
  [[nodiscard]] std::span<const log::Entry> take() { return take_while(&Waiting::has_old); }
  /// All that is left.
  [[nodiscard]] std::span<const log::Entry> take_all() { return take_while(&Waiting::has_any); }

 private:
  /// The frames of one bus, in the order in which they came.
  struct Waiting {
    std::vector<log::Entry> entries;
    std::size_t next = 0;
    std::size_t old = 0;  ///< the end of those from the rounds before
    [[nodiscard]] bool has_old() const { return next < old; }
    [[nodiscard]] bool has_any() const { return next < entries.size(); }
    void end_round() {
      entries.erase(entries.begin(), entries.begin() + static_cast<std::ptrdiff_t>(next));
      next = 0;
      old = entries.size();
    }
  };

  std::span<const log::Entry> take_while(bool (Waiting::*goes_on)() const) {
    taken_.clear();
    const auto wanted = [goes_on](const Waiting& bus) { return (bus.*goes_on)(); };
    while (std::any_of(buses_.begin(), buses_.end(), wanted)) {
      Waiting* earliest = nullptr;
      for (Waiting& bus : buses_)
        if (bus.has_any() &&
            (earliest == nullptr || bus.entries[bus.next].time < earliest->entries[earliest->next].time))
          earliest = &bus;
      taken_.push_back(earliest->entries[earliest->next++]);
    }
    for (Waiting& bus : buses_) bus.end_round();
    return taken_;
  }

  std::vector<Waiting> buses_;  ///< by number of the interface
  std::vector<log::Entry> taken_;
};

}  // namespace ocm::cli::record
