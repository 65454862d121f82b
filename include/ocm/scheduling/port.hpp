/// What the scheduling needs of the system that it runs on: a clock, one timer, a context a priority level,
/// and a short critical section. An RTOS, a bare machine, a host's threads and virtual time all have these;
/// docs/porting.md shows how to write one.
#pragma once

#include <concepts>

#include "ocm/base/time.hpp"
#include "ocm/scheduling/level.hpp"

namespace ocm::scheduling {

/// - `now()`: monotonic time. Any context.
/// - `arm(when)`: have the timer's context call `expire()` of the dispatcher at `when`, or as soon after as
/// the
///   clock allows (at once for a time that has passed). Replaces what was armed; base::never disarms.
/// - `pend(level)`: have the level's context call `run(level)`, once more even if it is running now. A
/// level's
///   context runs only while no more urgent one can, and is preempted by those.
/// - `lock()`: a guard; until it goes, no other context enters. Held for a bounded, short time; not nested.
///   `arm` and `pend` are called with the lock held, from any context.
template <class P>
concept Port = requires(P& port, base::Time when, Level level) {
  { port.now() } -> std::same_as<base::Time>;
  port.arm(when);
  port.pend(level);
  { port.lock() } -> std::destructible;
};

/// A port that also wants to know which levels still run (level_watch.hpp):
/// - `ran(level)`: the level has asked for work. Called with the lock held.
template <class P>
concept LevelWatcher = Port<P> && requires(P& port, Level level) {
  port.ran(level);
};

}  // namespace ocm::scheduling
