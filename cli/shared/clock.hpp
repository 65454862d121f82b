/// Time as the tool has it: here, and nowhere else in what sends, receives, records and plays, a clock is
/// read and is waited. clock.cpp asks the kernel. A test links tests/tool/clock/world.cpp in its
/// place: there time passes only when the code under test waits, so that hours take milliseconds and a run
/// can be repeated.
#pragma once

#include <algorithm>
#include <poll.h>
#include <span>

#include "ocm/base/time.hpp"

namespace ocm::cli {

/// Goes on at its own pace while the wall clock is set (CLOCK_MONOTONIC). Also while the program is stopped.
struct Clock {
  using duration = base::Duration;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<Clock, duration>;
  static constexpr bool is_steady = true;
  [[nodiscard]] static time_point now() noexcept;
};

/// So long behind `begin`; for ever where no clock gets that far.
[[nodiscard]] constexpr Clock::time_point time_after(Clock::time_point begin,
                                                     Clock::duration lasting) noexcept {
  const bool ever = lasting > Clock::time_point::max() - std::max(begin, Clock::time_point{});
  return ever ? Clock::time_point::max() : begin + lasting;
}

/// The wall clock's, as on frames: it can be set.
[[nodiscard]] base::Time unix_time() noexcept;

/// Up to when a bus has been listened to since this was made, by the clock of its frames: the wall clock. Of
/// a step forward, after which no frame may have come yet, it takes nothing: that was no silence.
class ListenedUntil {
 public:
  [[nodiscard]] base::Time now() const noexcept {
    return std::min(unix_time(), begin_ + (Clock::now() - steady_begin_));
  }

 private:
  base::Time begin_ = unix_time();
  Clock::time_point steady_begin_ = Clock::now();
};

/// How late it is by the clock of a bus's frames. That is the wall clock, unless it was set meanwhile: a bus
/// that does not follow (the simulator's) goes on as before, and one that does (the kernel's) is followed.
class FrameClock {
 public:
  /// A frame has come.
  void take(base::Time frame) noexcept {
    newest_ = frame;
    at_ = Clock::now();
  }
  [[nodiscard]] base::Time now() const noexcept {
    const base::Time by_frames = newest_ + (Clock::now() - at_);
    const base::Time wall = unix_time();
    const base::Duration apart = wall - by_frames;
    return apart > -most_waiting && apart < most_waiting ? wall : by_frames;
  }

 private:
  /// A frame may wait before it is taken. [decided]
  static constexpr base::Duration most_waiting = std::chrono::seconds{1};

  base::Time newest_ = unix_time();
  Clock::time_point at_ = Clock::now();
};

/// Each ends early when a signal was caught.
void sleep_for(base::Duration duration) noexcept;
void sleep_until(Clock::time_point time) noexcept;
/// Until one of them is readable, or that much time has passed. Whether one is.
[[nodiscard]] bool wait_for_input(std::span<pollfd> inputs, base::Duration longest) noexcept;

}  // namespace ocm::cli
