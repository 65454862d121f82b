/// Time is handed in, never read: every step of the library takes `now`, so that the same code runs on a
/// board, in real time on a host and in virtual time in a test.
#pragma once

#include <chrono>
#include <cstdint>

namespace ocm::base {

/// Signed nanoseconds: 292 years either way, and every bit time up to 1 Mbit/s is a whole number of them.
using Duration = std::chrono::duration<std::int64_t, std::nano>;

/// The clock that the caller owns. It has no `now()` on purpose.
struct Clock {
  using duration = Duration;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<Clock, duration>;
  static constexpr bool is_steady = true;
};

using Time = Clock::time_point;

/// A time that never comes.
inline constexpr Time never = Time::max();

}  // namespace ocm::base
