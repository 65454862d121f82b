/// Which stream is due, and when. Releases lie on a grid that starts when the request is received: the next
/// release is the last one plus the period, so a late taker delays one release and never the ones after it.
/// Who comes whole periods too late gets the newest grid point that has passed, and the skipped ones are
/// counted: at most one release is taken in one period of the grid, so releases are never bunched.
///
/// A stream that was taken is not taken again until `done`, whatever is asked for in between.
///
/// The caller passes `now`: no clock, no heap. 40 bytes a stream and 8 more; `take_due`, `due` and
/// `next_release` are O(N) in the number of streams, the others O(1). Not reentrant: a Dispatcher locks
/// around it.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

#include "ocm/base/time.hpp"
#include "ocm/scheduling/level.hpp"

namespace ocm::scheduling {

/// One release that is due now.
struct Release {
  std::size_t stream = 0;
  Level level = default_level;
  base::Time scheduled{};    ///< where the grid has it
  std::uint32_t missed = 0;  ///< releases before this one that were skipped
  bool late = false;         ///< taken later than the stream's jitter allows
  bool resumed = false;      ///< not new: what an earlier release left waiting may go on now
  friend constexpr bool operator==(const Release&, const Release&) = default;
};

/// What a stream could not keep up with, since the start. They wrap.
struct Overload {
  std::uint32_t missed = 0;   ///< releases skipped because a whole period had passed
  std::uint32_t late = 0;     ///< releases taken later than the jitter allows
  std::uint32_t overrun = 0;  ///< releases given up because the last one's outcome still waited
  friend constexpr bool operator==(const Overload&, const Overload&) = default;
};

template <std::size_t N>
class Publisher {
 public:
  static constexpr std::size_t streams = N;

  /// Publishes stream `stream` every `period` (above zero), the first time at `from`. On a running stream
  /// this replaces period, level and grid at once. A release later than `jitter` (one above 4.29 s is
  /// none) counts as late.
  constexpr void start(std::size_t stream, base::Duration period, Level level, base::Time from,
                       base::Duration jitter = base::Duration::max()) noexcept {
    Stream& s = streams_[stream];
    s.next = from;
    s.period = period;
    s.jitter_ns = nanoseconds(jitter);
    s.level = level;
    s.state = State::periodic;
  }
  /// One release at `when`, then none: a running stream stops at once.
  constexpr void once(std::size_t stream, Level level, base::Time when) noexcept {
    Stream& s = streams_[stream];
    s.next = when;
    s.jitter_ns = no_jitter;
    s.level = level;
    s.state = State::once;
  }
  /// Takes effect before the next release.
  constexpr void stop(std::size_t stream) noexcept { streams_[stream].state = State::idle; }

  [[nodiscard]] constexpr bool active(std::size_t stream) const noexcept {
    return streams_[stream].state == State::periodic;
  }
  [[nodiscard]] constexpr base::Duration period(std::size_t stream) const noexcept {
    return streams_[stream].period;
  }
  [[nodiscard]] constexpr Level level(std::size_t stream) const noexcept { return streams_[stream].level; }

  /// Takes a release of this level that is due at `now` into `release`: the one whose grid point is the
  /// earliest, of equal ones the lower stream number. False: none is due. The stream is taken until `done`.
  [[nodiscard]] constexpr bool take_due(base::Time now, Level level, Release& release) noexcept {
    std::size_t found = N;
    for (std::size_t i = 0; i < N; ++i) {
      const Stream& s = streams_[i];
      if (s.level != level || !s.takeable() || s.next > now) continue;
      if (found == N || s.next < streams_[found].next) found = i;
    }
    if (found == N) return false;

    Stream& s = streams_[found];
    release = {found, s.level, s.next, 0, false, false};
    s.taken_at = s.level;
    s.use = Use::taken;
    if (s.state == State::once) {
      s.state = State::idle;
      return true;
    }
    s.next += s.period;
    if (s.next <= now) {  // a whole period too late: go on with the newest grid point that has passed
      release.missed = s.skip_passed(now);
      release.scheduled = s.next - s.period;
      s.overload.missed += release.missed;
    }
    release.late =
        release.missed != 0 ||
        (s.jitter_ns != no_jitter && now - release.scheduled > base::Duration{std::int64_t{s.jitter_ns}});
    s.overload.late += release.late ? 1U : 0U;
    return true;
  }

  /// What the release did is not finished: it waits for something, and until then the stream is not taken.
  constexpr void hold(std::size_t stream) noexcept {
    streams_[stream].use = Use::held;
    ++held_;
  }
  /// A held stream of this level (the one that it was taken at), from number `from` on; N: there is none.
  [[nodiscard]] constexpr std::size_t held(Level level, std::size_t from = 0) const noexcept {
    if (held_ == 0) return N;  // nearly always: spares a look at each
    while (from < N && !(streams_[from].use == Use::held && streams_[from].taken_at == level)) ++from;
    return from;
  }
  /// The level that a stream in use was taken at.
  [[nodiscard]] constexpr Level taken_at(std::size_t stream) const noexcept {
    return streams_[stream].taken_at;
  }
  [[nodiscard]] constexpr bool in_use(std::size_t stream) const noexcept {
    return streams_[stream].use != Use::none;
  }
  /// The release is finished. Grid points that passed while it was held are given up, and counted; a single
  /// release is not, and comes now.
  constexpr void done(std::size_t stream, base::Time now) noexcept {
    Stream& s = streams_[stream];
    if (s.overdue_while_held(now)) s.overload.overrun += s.skip_passed(now);
    if (s.use == Use::held) --held_;
    s.use = Use::none;
  }

  /// Up to `now`, with what is already lost of a stream that is held, or that no context takes.
  [[nodiscard]] constexpr Overload overload(std::size_t stream, base::Time now) const noexcept {
    Stream s = streams_[stream];
    if (s.overdue_while_held(now))
      s.overload.overrun += s.skip_passed(now);
    else if (s.state == State::periodic && s.next <= now)
      s.overload.missed += s.skip_passed(now) - 1;  // the newest one may still be taken
    return s.overload;
  }

  /// Of all streams and kinds together.
  [[nodiscard]] constexpr std::uint64_t overload(base::Time now) const noexcept {
    std::uint64_t sum = 0;
    for (std::size_t stream = 0; stream < N; ++stream) {
      const Overload one = overload(stream, now);
      sum += std::uint64_t{one.missed} + one.late + one.overrun;
    }
    return sum;
  }

  /// When the stream can be taken next; base::never when it does not run, or not until it is done.
  [[nodiscard]] constexpr base::Time next_release(std::size_t stream) const noexcept {
    return streams_[stream].takeable() ? streams_[stream].next : base::never;
  }
  /// When the first of them all can be taken.
  [[nodiscard]] constexpr base::Time next_release() const noexcept {
    base::Time next = base::never;
    for (const Stream& s : streams_)
      if (s.takeable() && s.next < next) next = s.next;
    return next;
  }

  struct Due {
    std::uint8_t levels = 0;        ///< a bit for each that has a stream due
    base::Time next = base::never;  ///< the first release after now
  };
  [[nodiscard]] constexpr Due due(base::Time now) const noexcept {
    Due result;
    for (const Stream& s : streams_) {
      if (!s.takeable()) continue;
      if (s.next <= now)
        result.levels = static_cast<std::uint8_t>(result.levels | 1U << static_cast<unsigned>(s.level));
      else if (s.next < result.next)
        result.next = s.next;
    }
    return result;
  }

 private:
  static constexpr std::uint32_t no_jitter = UINT32_MAX;
  enum class State : std::uint8_t { idle, periodic, once };
  enum class Use : std::uint8_t { none, taken, held };
  struct Stream {
    base::Time next{};
    base::Duration period{};
    std::uint32_t jitter_ns = no_jitter;
    Overload overload{};
    Level level = default_level;
    Level taken_at = default_level;
    State state = State::idle;
    Use use = Use::none;

    [[nodiscard]] constexpr bool takeable() const noexcept {
      return state != State::idle && use == Use::none;
    }
    [[nodiscard]] constexpr bool overdue_while_held(base::Time now) const noexcept {
      return use == Use::held && state == State::periodic && next <= now;
    }
    /// Moves `next`, which has passed, behind `now`; says over how many grid points.
    constexpr std::uint32_t skip_passed(base::Time now) noexcept {
      const std::int64_t skipped = (now - next) / period + 1;
      next += skipped * period;
      return skipped > UINT32_MAX ? UINT32_MAX : static_cast<std::uint32_t>(skipped);
    }
  };
  static_assert(sizeof(Stream) <= 40);

  [[nodiscard]] static constexpr std::uint32_t nanoseconds(base::Duration jitter) noexcept {
    const std::int64_t ns = jitter.count();
    return ns < 0 ? 0 : ns > no_jitter ? no_jitter : static_cast<std::uint32_t>(ns);
  }

  std::array<Stream, N> streams_{};
  std::size_t held_ = 0;  // how many
};

}  // namespace ocm::scheduling
