/// Runs streams at four priority levels, each level in a context of its own that preempts the ones below.
/// Deterministic within a level: the release whose grid point is the earliest goes first, of equal ones the
/// lower stream number; a job runs to its end before the level's next one.
///
///     receiving context   start / once / stop          a request
///     timer context       expire                       at the time that the port was armed for
///     level's context     run(level, job)              after the port was pended for the level
///     any context         wake                         what held streams wait for is there
///
/// A stream's job is never in two contexts: while it runs, what is asked for is only noted, and acts from the
/// stream's next release, at the level asked for. A stop that returned before a release was taken prevents
/// it.
///
/// Memory: 40 bytes a stream and 24 more. `take` and `expire` look at each stream once, the rest is O(1);
/// what that costs on a Cortex-M3 is in docs/scheduling.md. Every function holds the port's lock for its own
/// time, jobs run without it. No heap.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "ocm/base/time.hpp"
#include "ocm/scheduling/port.hpp"
#include "ocm/scheduling/publisher.hpp"

namespace ocm::scheduling {

/// What a job says at its end.
enum class Outcome : std::uint8_t {
  done,
  waits,  ///< call me again with `resumed` set, after `wake`: until then the stream is not released
};

template <std::size_t Streams, Port P>
class Dispatcher {
 public:
  /// The port must outlive the dispatcher.
  constexpr explicit Dispatcher(P& port) noexcept : port_(&port) {}
  Dispatcher(const Dispatcher&) = delete;
  Dispatcher& operator=(const Dispatcher&) = delete;

  /// Releases `stream` every `period` (above zero) from `from` on, at `level`. On a running stream this
  /// replaces period, level and grid; what was due and not yet taken is replaced too.
  void start(std::size_t stream, base::Duration period, Level level, base::Time from,
             base::Duration jitter = base::Duration::max()) noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    publisher_.start(stream, period, level, from, jitter);
    attend(stream);
  }
  /// One release at `when`, which may lie ahead; the stream's other releases end.
  void once(std::size_t stream, Level level, base::Time when) noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    publisher_.once(stream, level, when);
    attend(stream);
  }
  /// The same at the time that `when()` says, which is asked with the lock held; base::never: not at all. For
  /// an alarm whose time several contexts move.
  template <std::invocable F>
  void once(std::size_t stream, Level level, F when) noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    const base::Time at = when();
    if (at == base::never) return publisher_.stop(stream);
    publisher_.once(stream, level, at);
    attend(stream);
  }
  /// One release at `when`, unless the stream publishes: its next release is as good, and none of them ends.
  void once_unless_active(std::size_t stream, Level level, base::Time when) noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    if (publisher_.active(stream)) return;
    publisher_.once(stream, level, when);
    attend(stream);
  }
  /// No release is taken after this.
  void stop(std::size_t stream) noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    publisher_.stop(stream);  // the timer may go off for nothing: that is cheaper than to look for the next
  }

  /// The port's timer went off; too early is harmless.
  void expire() noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    const auto due = publisher_.due(port_->now());
    for (unsigned level = 0; level < level_count; ++level)
      if ((due.levels >> level & 1U) != 0) port_->pend(static_cast<Level>(level));
    armed_ = base::never;
    arm_by(due.next);
  }

  /// Streams that are held may go on: a bus has room again. Also those that are running, which may have found
  /// it full a moment ago and are not held yet.
  void wake() noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    for (std::size_t stream = 0; stream < Streams; ++stream)
      if (publisher_.in_use(stream)) port_->pend(publisher_.taken_at(stream));
  }

  /// Does what there is to do at `level`: job(const Release&) -> Outcome for each stream that was held, then
  /// for each release that is due. To be called from the level's context only.
  template <class Job>
  void run(Level level, Job&& job) noexcept {
    Release release;
    for (std::size_t stream = held(level, 0); stream < Streams; stream = held(level, stream + 1)) {
      release = {stream, level, {}, 0, false, true};
      if (job(std::as_const(release)) == Outcome::done) done(stream);
    }
    while (take(level, release))
      job(std::as_const(release)) == Outcome::done ? done(release.stream) : hold(release.stream);
  }

  // What `run` is made of, for a port that calls jobs itself
  [[nodiscard]] bool take(Level level, Release& release) noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    if constexpr (LevelWatcher<P>) port_->ran(level);
    return publisher_.take_due(port_->now(), level, release);
  }
  void done(std::size_t stream) noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    publisher_.done(stream, port_->now());
    attend(stream);
  }
  void hold(std::size_t stream) noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    publisher_.hold(stream);
  }

  [[nodiscard]] bool active(std::size_t stream) const noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    return publisher_.active(stream);
  }
  /// How many streams publish now.
  [[nodiscard]] std::size_t active() const noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    std::size_t count = 0;
    for (std::size_t stream = 0; stream < Streams; ++stream) count += publisher_.active(stream) ? 1U : 0U;
    return count;
  }
  /// A stream waits for `wake`.
  [[nodiscard]] bool waiting() const noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    for (unsigned level = 0; level < level_count; ++level)
      if (publisher_.held(static_cast<Level>(level)) < Streams) return true;
    return false;
  }
  [[nodiscard]] Overload overload(std::size_t stream) const noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    return publisher_.overload(stream, port_->now());
  }
  /// Of all streams and kinds together.
  [[nodiscard]] std::uint64_t overload() const noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    return publisher_.overload(port_->now());
  }
  /// When the first stream can be taken; it may have passed. base::never: none runs.
  [[nodiscard]] base::Time next_release() const noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    return publisher_.next_release();
  }

 private:
  [[nodiscard]] std::size_t held(Level level, std::size_t from) const noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    return publisher_.held(level, from);
  }
  /// The stream has changed: pends its level, or makes sure that the timer goes off in time.
  void attend(std::size_t stream) noexcept {
    const base::Time next = publisher_.next_release(stream);
    if (next <= port_->now())
      port_->pend(publisher_.level(stream));
    else
      arm_by(next);
  }
  void arm_by(base::Time when) noexcept {
    if (when >= armed_) return;
    armed_ = when;
    port_->arm(when);
  }

  P* port_;
  base::Time armed_ = base::never;
  Publisher<Streams> publisher_;
};

}  // namespace ocm::scheduling
