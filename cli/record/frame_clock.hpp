/// When frames came, by the monotonic clock, to the precision of their own times. Those alone are not enough:
/// the clock of a robot without a battery for it is set minutes after it has started, by years, and back
/// again.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <optional>
#include <span>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/log/entry.hpp"

namespace ocm::cli::record {

class FrameClock {
 public:
  /// How far the frames' times may run from the monotonic clock, in either direction, before they count as
  /// set. Decided: more than a frame waits to be fetched, less than a difference between files that matters.
  static constexpr base::Duration tolerance = std::chrono::milliseconds{200};

  /// The entries were fetched at `now` of the monotonic clock. Before `at` is asked for them.
  void fetched(std::span<const log::Entry> entries, base::Duration now) {
    now_ = now;
    // The newest frame of each interface was on the bus just now; each interface has a clock of its own.
    for (auto entry = entries.rbegin(); entry != entries.rend(); ++entry) {
      if (entry->interface >= interfaces_.size()) interfaces_.resize(entry->interface + std::size_t{1});
      Interface& interface = interfaces_[entry->interface];
      if (interface.seen == batch_) continue;
      interface.seen = batch_;
      const base::Duration own = entry->time.time_since_epoch();
      if (!interface.ahead || std::chrono::abs(own - *interface.ahead - now) > tolerance)
        interface.ahead = own - now;
    }
    ++batch_;
  }

  /// When the entry came, by the monotonic clock. Never earlier than the entry that was asked for before.
  [[nodiscard]] base::Duration at(const log::Entry& entry) {
    const base::Duration came =
        entry.time.time_since_epoch() - interfaces_[entry.interface].ahead.value_or(base::Duration{});
    // Frames from before and after the clock was set may come together: the former lie anywhere.
    last_ = std::max(last_.value_or(came), std::min(came, now_ + tolerance));
    return *last_;
  }

 private:
  struct Interface {
    std::optional<base::Duration> ahead;  ///< of the monotonic clock
    std::size_t seen = 0;                 ///< the number of the batch that it was last in
  };
  std::vector<Interface> interfaces_;
  std::size_t batch_ = 1;
  base::Duration now_{};
  std::optional<base::Duration> last_;
};

}  // namespace ocm::cli::record
