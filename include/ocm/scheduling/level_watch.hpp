/// Whether every level still runs: what a hardware watchdog is fed by. A level proves it by asking the
/// dispatcher for work (Dispatcher::take), before each job and after the last; a job that does not come back
/// asks for nothing. A level that has nothing to do for a while is pended now and then (`due`), asks, finds
/// nothing, and has proved it. So an idle level never starves the watchdog, and neither does one that always
/// has work.
///
///     port.ran(level):   watch.ran(level)                        // the dispatcher calls it, with the lock
///     held lowest level:      if (watch.due(now)) pend every level
///                        if (watch.complete()) feed the watchdog
///
/// Every function is to be called with the port's lock held. Memory: 24 bytes. No heap.
#pragma once

#include <cstdint>

#include "ocm/base/time.hpp"
#include "ocm/scheduling/level.hpp"

namespace ocm::scheduling {

class LevelWatch {
 public:
  /// `period` (above zero): how often the levels are called up. The watchdog is fed once in that time and in
  /// the longest job's; its timeout must be longer than both together.
  constexpr explicit LevelWatch(base::Duration period) noexcept : period_(period) {}

  /// The level asked for work.
  constexpr void ran(Level level) noexcept { ran_ = static_cast<std::uint8_t>(ran_ | bit(level)); }

  /// Once a period, and at the first call: every level is to be pended now.
  [[nodiscard]] constexpr bool due(base::Time now) noexcept {
    if (now < next_) return false;
    next_ = now + period_;
    return true;
  }

  /// True once: every level has run since it was last true.
  [[nodiscard]] constexpr bool complete() noexcept {
    if (ran_ != all) return false;
    ran_ = 0;
    return true;
  }

 private:
  static constexpr std::uint8_t all = (1U << level_count) - 1;
  [[nodiscard]] static constexpr std::uint8_t bit(Level level) noexcept {
    return static_cast<std::uint8_t>(1U << static_cast<unsigned>(level));
  }

  base::Duration period_;
  base::Time next_{};
  std::uint8_t ran_ = 0;
};

}  // namespace ocm::scheduling
