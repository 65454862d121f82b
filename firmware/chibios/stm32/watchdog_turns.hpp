/// The window watchdog's time (WWDG), and how long it is fed without a sign of the levels. It counts PCLK1 /
/// 4096 / 8 and resets the chip at the end of a turn, unless its early interrupt, one count before, begins
/// another. A turn takes 50 to 57 ms, so that interrupt goes on for some turns without new proof from the
/// levels, and then ends the program in an orderly way. When it does not come, the chip resets itself.
/// [RM0008 20.3 to 20.6, RM0090 22.3 to 22.6]
#pragma once

#include <chrono>
#include <cstdint>

#include "ocm/base/time.hpp"

namespace ocm::firmware::chibios::stm32 {

/// Why not the independent watchdog: docs/decisions/0028-the-window-watchdog.md.
class WatchdogTurns {
 public:
  static constexpr std::uint32_t reload = 0x7F;           ///< of its 7 bits
  static constexpr std::uint32_t early_interrupt = 0x40;  ///< the count at which it comes; 0x3F resets

  /// From one early interrupt to the next.
  [[nodiscard]] static constexpr base::Duration turn(std::uint32_t pclk1_hz) noexcept {
    return count(pclk1_hz) * (reload - early_interrupt);
  }
  /// From the early interrupt to the reset, if it does not come.
  [[nodiscard]] static constexpr base::Duration count(std::uint32_t pclk1_hz) noexcept {
    return std::chrono::nanoseconds{std::int64_t{4096} * 8 * 1'000'000'000 / pclk1_hz};
  }
  /// The most turns that are not longer than `patience`; at least one.
  [[nodiscard]] static constexpr std::uint32_t turns_in(base::Duration patience,
                                                        std::uint32_t pclk1_hz) noexcept {
    const auto turns = patience / turn(pclk1_hz);
    return turns < 1 ? 1U : static_cast<std::uint32_t>(turns);
  }

  /// In a turn that is over: whether to begin another. False for good once `turns` of them have passed
  /// without fed().
  [[nodiscard]] constexpr bool next(std::uint32_t turns) noexcept {
    if (unfed_ + 1 >= turns) return false;
    unfed_ = unfed_ + 1;
    return true;
  }
  /// Every level has run. A single store: `next` may interrupt it.
  constexpr void fed() noexcept { unfed_ = 0; }

 private:
  std::uint32_t unfed_ = 0;
};

}  // namespace ocm::firmware::chibios::stm32
