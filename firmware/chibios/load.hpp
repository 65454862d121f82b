/// How busy a board's CPU is, from the time in which no thread had anything to do.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

#include "ocm/base/time.hpp"
#include "ocm/controller/report.hpp"

#include "firmware/chibios/port.hpp"

namespace ocm::firmware::chibios {

/// `look` in one thread, `percent` in any. Interrupts while the CPU idles count as idle.
class LoadMeter {
 public:
  static constexpr base::Duration window = std::chrono::seconds{1};

  explicit LoadMeter(Port& port) noexcept : port_(&port) {}

  /// To be called more often than once in a window.
  void look(base::Time now) noexcept {
    const base::Duration elapsed = now - since_;
    if (elapsed < window) return;
    const base::Duration idle = port_->idle();
    percent_ =
        static_cast<std::uint8_t>(std::clamp<std::int64_t>(100 - (idle - idle_) * 100 / elapsed, 0, 100));
    since_ = now;
    idle_ = idle;
  }
  /// Of the last whole window; Health::unknown_load before its end.
  [[nodiscard]] std::uint8_t percent() const noexcept { return percent_; }

 private:
  Port* port_;
  base::Time since_{};
  base::Duration idle_{};
  std::uint8_t percent_ = controller::Health::unknown_load;
};

}  // namespace ocm::firmware::chibios
