/// What an operator that systemd runs reports to it: that it has begun, what it does, and that it still runs
/// [sd_notify(3)]. Nothing where no systemd asks.
#pragma once

#include <string>
#include <string_view>

#include "ocm/base/time.hpp"

#include "cli/shared/clock.hpp"

namespace ocm::cli::operate {

class Service {
 public:
  /// By NOTIFY_SOCKET and WATCHDOG_USEC.
  Service();

  void ready(std::string_view status) { tell("READY=1\nSTATUS=", status); }
  void status(std::string_view status) { tell("STATUS=", status); }
  void stopping() { tell("STOPPING=1", {}); }
  /// The loop goes round. Tells it twice in the time that systemd waits.
  void runs(Clock::time_point now) {
    if (now < next_) return;
    next_ = now + every_;
    tell("WATCHDOG=1", {});
  }
  /// When `runs` has something to tell; never: time_point::max().
  [[nodiscard]] Clock::time_point next() const noexcept { return next_; }

 private:
  void tell(std::string_view what, std::string_view text) const;

  std::string socket_;
  base::Duration every_{};
  Clock::time_point next_ = Clock::time_point::max();
};

}  // namespace ocm::cli::operate
