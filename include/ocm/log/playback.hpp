/// When the frames of a log are due if it is played again: each at its own distance from the first, so that
/// no error adds up however long the log is. The caller owns the clock and hands its time in.
///
/// A time that goes back a little (frames of two interfaces, written as they were read) is due at once. One
/// that goes back a second or more is a clock that was set, or another log behind the first: from there on
/// distances count afresh. O(1) a frame, no heap.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>

#include "ocm/base/time.hpp"

namespace ocm::log {

struct PlaybackOptions {
  double speed = 1;  ///< how many times faster; above 0
  /// A longer pause between two frames is cut to this, before the speed is applied.
  base::Duration longest_gap = base::Duration::max();
};

class Playback {
 public:
  /// Times that go back by less are out of order; by more, the clock was set.
  static constexpr base::Duration clock_was_set = std::chrono::seconds{1};
  /// No scheduler is better on every machine; less is not reported.
  static constexpr base::Duration late_from = std::chrono::milliseconds{1};

  explicit Playback(PlaybackOptions options = {}) noexcept : options_(options) {}

  /// What was recorded at `recorded` is due at `start`. Once before the first frame, and again for each pass.
  void begin(base::Time start, base::Time recorded) noexcept {
    start_ = due_ = start;
    origin_ = newest_ = recorded;
  }

  /// When a frame is due: never before the one that was asked for last.
  [[nodiscard]] base::Time due(base::Time recorded) noexcept {
    const base::Duration step = distance(recorded, newest_);
    if (step < base::Duration::zero()) {
      ++backward_;
      if (-clock_was_set < step) return due_;
      begin(due_, recorded);
      return due_;
    }
    if (step > options_.longest_gap) {
      ++cut_;
      begin(after(due_, options_.longest_gap), recorded);
      return due_;
    }
    newest_ = recorded;
    due_ = after(start_, distance(recorded, origin_));
    return due_;
  }

  /// A frame that was due at `due` went out at `now`.
  void sent(base::Time due, base::Time now) noexcept {
    const base::Duration lateness = now - due;
    if (lateness >= late_from) ++late_;
    worst_ = std::max(worst_, lateness);
  }

  [[nodiscard]] std::uint64_t backward() const noexcept { return backward_; }  ///< times that went back
  [[nodiscard]] std::uint64_t cut() const noexcept { return cut_; }            ///< pauses that were cut
  [[nodiscard]] std::uint64_t late() const noexcept { return late_; }     ///< frames, by `late_from` or more
  [[nodiscard]] base::Duration worst() const noexcept { return worst_; }  ///< lateness
  /// Of the last frame that was asked for.
  [[nodiscard]] base::Time last_due() const noexcept { return due_; }

  /// From `earlier` to `later`. A log may hold any two times; what no number of 64 bits holds is the longest
  /// that one does.
  [[nodiscard]] static base::Duration distance(base::Time later, base::Time earlier) noexcept {
    std::int64_t result = 0;
    const std::int64_t a = later.time_since_epoch().count(), b = earlier.time_since_epoch().count();
    if (!__builtin_sub_overflow(a, b, &result)) return base::Duration{std::max(result, -longest)};
    return base::Duration{a > b ? longest : -longest};
  }

  /// The sum, or the last or first time that there is.
  [[nodiscard]] static base::Time later(base::Time time, base::Duration by) noexcept {
    std::int64_t result = 0;
    if (!__builtin_add_overflow(time.time_since_epoch().count(), by.count(), &result))
      return base::Time{base::Duration{result}};
    return by < base::Duration::zero() ? base::Time::min() : base::Time::max();
  }

 private:
  static constexpr std::int64_t longest = std::numeric_limits<std::int64_t>::max();

  [[nodiscard]] base::Time after(base::Time start, base::Duration recorded) const noexcept {
    std::int64_t passed = recorded.count();
    if (options_.speed != 1) {  // 53 bits: exact to a nanosecond for 104 days
      const double scaled = static_cast<double>(passed) / options_.speed;
      passed = scaled < static_cast<double>(longest) ? std::llround(scaled) : longest;
    }
    std::int64_t result = 0;
    if (__builtin_add_overflow(start.time_since_epoch().count(), passed, &result)) return base::never;
    return base::Time{base::Duration{result}};
  }

  PlaybackOptions options_;
  base::Time start_{};
  base::Time origin_{};
  base::Time newest_{};
  base::Time due_{};
  std::uint64_t backward_ = 0;
  std::uint64_t cut_ = 0;
  std::uint64_t late_ = 0;
  base::Duration worst_{};
};

}  // namespace ocm::log
