/// The port of a program that has one context: a superloop, a simulator, a test. Time is handed in, a pended
/// level is remembered, and nothing preempts anything.
///
///     port.advance(now);
///     if (port.armed() <= now) dispatcher.expire();
///     for (Level level; port.take_pended(level);) dispatcher.run(level, job);
///
/// 24 bytes, O(1). No heap, no lock: call all of it from one context.
#pragma once

#include <bit>
#include <cstdint>

#include "ocm/base/time.hpp"
#include "ocm/scheduling/port.hpp"

namespace ocm::scheduling {

class Cooperative {
 public:
  struct Guard {};

  constexpr explicit Cooperative(base::Time start = {}) noexcept : now_(start) {}
  Cooperative(const Cooperative&) = delete;  // a dispatcher holds its address
  Cooperative& operator=(const Cooperative&) = delete;

  // As a port
  [[nodiscard]] constexpr base::Time now() const noexcept { return now_; }
  constexpr void arm(base::Time when) noexcept { armed_ = when; }
  constexpr void pend(Level level) noexcept {
    pended_ = static_cast<std::uint8_t>(pended_ | 1U << static_cast<unsigned>(level));
  }
  [[nodiscard]] constexpr Guard lock() const noexcept { return {}; }

  // For the loop
  /// It is `now`. A time before the last one is ignored.
  constexpr void advance(base::Time now) noexcept {
    if (now > now_) now_ = now;
  }
  /// When `expire` is to be called; base::never: not at all.
  [[nodiscard]] constexpr base::Time armed() const noexcept { return armed_; }
  /// Something is to be run at once.
  [[nodiscard]] constexpr bool pended() const noexcept { return pended_ != 0; }
  /// Takes the most urgent level that is to be run into `level`. False: none is.
  [[nodiscard]] constexpr bool take_pended(Level& level) noexcept {
    if (pended_ == 0) return false;
    level = static_cast<Level>(std::countr_zero(pended_));
    pended_ = static_cast<std::uint8_t>(pended_ & (pended_ - 1U));
    return true;
  }

 private:
  base::Time now_;
  base::Time armed_ = base::never;
  std::uint8_t pended_ = 0;
};

static_assert(Port<Cooperative>);

}  // namespace ocm::scheduling
