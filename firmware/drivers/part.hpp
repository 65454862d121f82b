/// Looks after one part: configures it, waits until its samples are good, notices when it no longer answers,
/// and tries again on a grid. The driver says how, this says when.
///
/// Two contexts meet here: `use` (the level that serves the part's topic) and `maintain` (one low level,
/// every few milliseconds). They share two atomics that are only loaded and stored, so this holds on a
/// Cortex-M0 too. `use` never waits for a part that is away; `maintain` does one start or check a call at the
/// most. 16 bytes and the driver. Not copyable.
#pragma once

#include <atomic>
#include <chrono>
#include <concepts>
#include <cstdint>
#include <utility>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"

namespace ocm::firmware::drivers {

/// How often a part that is away is tried, and one that is there is asked whether it still is what was
/// configured: a part that lost its power for a moment answers, but measures nothing. [decided]
inline constexpr base::Duration retry_period = std::chrono::seconds{1};
inline constexpr base::Duration check_period = std::chrono::seconds{1};

/// - `start()`: is this the right part? Then configure it. The value is how long its samples are no good yet.
/// - `check()`: does it still answer, with the configuration that it was given?
template <class D>
concept Driver = requires(D& driver) {
  { driver.start() } -> std::same_as<base::Result<base::Duration>>;
  { driver.check() } -> std::same_as<base::Status>;
};

template <Driver D>
class Part {
 public:
  template <class... Arguments>
  explicit Part(Arguments&&... arguments) : driver_(std::forward<Arguments>(arguments)...) {}
  Part(const Part&) = delete;
  Part& operator=(const Part&) = delete;

  /// `what(driver)` when the part is there. Error::no_answer when it is not, Error::not_sampled while its
  /// first sample is not ready. A failure, other than not_sampled, takes the part for lost.
  template <class F>
  auto use(F what) -> decltype(what(std::declval<D&>())) {
    const State state = state_.load(std::memory_order_acquire);
    if (state == State::absent) return base::Error::no_answer;
    if (state == State::settling) return base::Error::not_sampled;
    auto result = what(driver_);
    if (!result && result.error != base::Error::not_sampled) lose();
    return result;
  }

  /// One step of looking after it; true when the bus was used. From one context only.
  bool maintain(base::Time now) {
    const State state = state_.load(std::memory_order_acquire);
    // Lost since the last call: tried at once, unless it was only just started. So no part, however it
    // flaps, costs more than one start in a `retry_period`.
    if (state == State::absent && seen_ == State::running) due_ = started_ + retry_period;
    seen_ = state;
    if (now < due_) return false;
    switch (state) {
      case State::absent: {
        started_ = now;
        const auto settling = driver_.start();
        due_ = now + (settling ? *settling : retry_period);
        if (settling)
          state_.store(State::settling, std::memory_order_release);
        else
          count();
        return true;
      }
      case State::settling:
        due_ = now + check_period;
        seen_ = State::running;
        state_.store(State::running, std::memory_order_release);
        return false;
      case State::running:
        due_ = now + check_period;
        if (!driver_.check()) lose();  // and the next call tries to start it
        return true;
    }
    return false;
  }

  /// No part answers, or another one.
  [[nodiscard]] bool absent() const noexcept {
    return state_.load(std::memory_order_relaxed) == State::absent;
  }
  [[nodiscard]] bool running() const noexcept {
    return state_.load(std::memory_order_relaxed) == State::running;
  }
  /// Starts, checks and reads that failed; stays at 65535. Of two failures at the same instant in two
  /// contexts one may go uncounted.
  [[nodiscard]] std::uint16_t faults() const noexcept { return faults_.load(std::memory_order_relaxed); }

  [[nodiscard]] D& driver() noexcept { return driver_; }
  [[nodiscard]] const D& driver() const noexcept { return driver_; }

 private:
  enum class State : std::uint8_t { absent, settling, running };

  void lose() noexcept {
    count();
    state_.store(State::absent, std::memory_order_release);
  }
  void count() noexcept {
    const std::uint16_t faults = faults_.load(std::memory_order_relaxed);
    if (faults != 65535) faults_.store(static_cast<std::uint16_t>(faults + 1), std::memory_order_relaxed);
  }

  D driver_;
  base::Time due_{};
  base::Time started_{};
  State seen_ = State::absent;
  std::atomic<State> state_{State::absent};
  std::atomic<std::uint16_t> faults_{0};
};

}  // namespace ocm::firmware::drivers
