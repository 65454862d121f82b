/// Brings an actuator to rest when no command has come for a while: an operator that hangs, or a cable
/// that comes off, must not leave a robot driving.
#pragma once

#include "ocm/base/time.hpp"

namespace ocm::controller {

class Watchdog {
 public:
  constexpr Watchdog() = default;  ///< never expires
  /// A timeout of zero never expires.
  constexpr explicit Watchdog(base::Duration timeout) noexcept : timeout_(timeout) {}

  /// A command came.
  constexpr void feed(base::Time now) noexcept {
    if (timeout_.count() > 0) expires_at_ = now + timeout_;
  }
  /// The actuator is at rest by command: there is nothing to watch.
  constexpr void rest() noexcept { expires_at_ = base::never; }
  /// True once when the timeout has passed since the last command.
  [[nodiscard]] constexpr bool expire(base::Time now) noexcept {
    if (now < expires_at_) return false;
    expires_at_ = base::never;
    return true;
  }
  [[nodiscard]] constexpr base::Time expires_at() const noexcept { return expires_at_; }
  [[nodiscard]] constexpr base::Duration timeout() const noexcept { return timeout_; }

 private:
  base::Duration timeout_{};
  base::Time expires_at_ = base::never;
};

}  // namespace ocm::controller
