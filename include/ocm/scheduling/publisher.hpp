/// Which topic is due, and when. Releases lie on a grid that starts when the request is received: the next
/// release is the last one plus the period, so a late caller delays one release and never the ones after it.
/// Whole periods that passed are skipped and counted; releases are never bunched.
///
/// The caller passes `now`: no clock, no heap. 40 bytes a topic; `take_due` and `next_release` are O(N) in
/// the number of topics. Not reentrant.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "ocm/base/time.hpp"
#include "ocm/protocol/identifier.hpp"

namespace ocm::scheduling {

/// One release that is due now.
struct Release {
  std::size_t stream = 0;
  protocol::Priority priority = protocol::default_priority;
  base::Time scheduled{};    ///< where the grid has it
  std::uint32_t missed = 0;  ///< releases before this one that were skipped
  bool late = false;         ///< taken later than the stream's jitter allows
  friend constexpr bool operator==(const Release&, const Release&) = default;
};

template <std::size_t N>
class Publisher {
 public:
  /// Publishes stream `stream` every `period` (above zero), the first time at once. On a running stream this
  /// replaces period, priority and grid at once. A release later than `jitter` counts as late.
  constexpr void start(std::size_t stream, base::Duration period, protocol::Priority priority, base::Time now,
                       base::Duration jitter = base::Duration::max()) noexcept {
    streams_[stream] = {now, period, jitter, priority, State::periodic};
  }
  /// One release at once, then none: a running stream stops.
  constexpr void once(std::size_t stream, protocol::Priority priority, base::Time now) noexcept {
    streams_[stream] = {now, base::Duration{0}, base::Duration::max(), priority, State::once};
  }
  /// Takes effect before the next release.
  constexpr void stop(std::size_t stream) noexcept { streams_[stream].state = State::idle; }

  [[nodiscard]] constexpr bool active(std::size_t stream) const noexcept {
    return streams_[stream].state == State::periodic;
  }
  [[nodiscard]] constexpr base::Duration period(std::size_t stream) const noexcept {
    return streams_[stream].period;
  }
  [[nodiscard]] constexpr protocol::Priority priority(std::size_t stream) const noexcept {
    return streams_[stream].priority;
  }

  /// Takes the most urgent release that is due at `now` (equal priorities: the lower stream number) into
  /// `release`. False: none is due.
  [[nodiscard]] constexpr bool take_due(base::Time now, Release& release) noexcept {
    std::size_t found = N;
    for (std::size_t i = 0; i < N; ++i) {
      const Stream& s = streams_[i];
      if (s.state == State::idle || s.next > now) continue;
      if (found == N || s.priority < streams_[found].priority) found = i;
    }
    if (found == N) return false;

    Stream& stream = streams_[found];
    release = {found, stream.priority, stream.next, 0, false};
    if (stream.state == State::once) {
      stream.state = State::idle;
      return true;
    }
    stream.next += stream.period;
    if (stream.next <= now) {  // a whole period too late: go on with the newest grid point that has passed
      const std::int64_t skipped = (now - stream.next) / stream.period + 1;
      stream.next += skipped * stream.period;
      release.scheduled = stream.next - stream.period;
      release.missed = skipped > UINT32_MAX ? UINT32_MAX : static_cast<std::uint32_t>(skipped);
    }
    release.late = release.missed != 0 || now - release.scheduled > stream.jitter;
    return true;
  }

  /// When the next release is due; base::never when nothing runs.
  [[nodiscard]] constexpr base::Time next_release() const noexcept {
    base::Time next = base::never;
    for (const Stream& s : streams_)
      if (s.state != State::idle && s.next < next) next = s.next;
    return next;
  }

 private:
  enum class State : std::uint8_t { idle, periodic, once };
  struct Stream {
    base::Time next{};
    base::Duration period{};
    base::Duration jitter{};
    protocol::Priority priority = protocol::default_priority;
    State state = State::idle;
  };
  std::array<Stream, N> streams_{};
};

}  // namespace ocm::scheduling
