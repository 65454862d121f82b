/// How much of the processor a robot's jobs take, by a clock alone: for a port that does not measure its own
/// idle time. A job that was preempted counts without those that ran in between, where jobs nest as on one
/// processor. What no job accounts for, interrupts and the system itself, counts as idle. Two sums, O(1) a
/// job; its caller locks around it.
#pragma once

#include "ocm/base/time.hpp"

namespace ocm::mapper::app {

class Load {
 public:
  /// What a job remembers while it runs.
  struct Begun {
    base::Time at{};
    base::Duration busy{};
  };

  [[nodiscard]] constexpr Begun begin(base::Time now) const noexcept { return {now, busy_}; }
  constexpr void end(const Begun& begun, base::Time now) noexcept {
    const base::Duration others = busy_ - begun.busy;
    const base::Duration own = now - begun.at - others;
    if (own > base::Duration::zero()) busy_ += own;
  }
  [[nodiscard]] constexpr base::Duration busy() const noexcept { return busy_; }

 private:
  base::Duration busy_{};
};

}  // namespace ocm::mapper::app
