/// The totals of a wheel from a counter of 16 bits that wraps.
///
/// One context samples; any other may ask for the total, which reads one atomic word: the total's low half is
/// the counter's value when it was sampled, so nothing has to be read together with it. 4 bytes.
#pragma once

#include <atomic>
#include <cstdint>

namespace ocm::firmware::drivers {

class WheelCounter {
 public:
  /// Ticks since the last sample, forwards positive. Right when the wheel went less than 32768 ticks, 4 m.
  /// The first sample's is 0. From one context only.
  std::int16_t sample(std::uint16_t counter) noexcept {
    const std::uint32_t before = total_.load(std::memory_order_relaxed);
    const std::int16_t moved = started_ ? since(before, counter) : std::int16_t{0};
    const std::uint32_t now = started_ ? before + static_cast<std::uint32_t>(std::int32_t{moved})
                                       : static_cast<std::uint32_t>(static_cast<std::int16_t>(counter));
    started_ = true;
    total_.store(now, std::memory_order_relaxed);
    return moved;
  }

  /// The total when the counter is at `counter`: of the last sample, and what came since. Any context.
  [[nodiscard]] std::int32_t total(std::uint16_t counter) const noexcept {
    const std::uint32_t total = total_.load(std::memory_order_relaxed);
    return static_cast<std::int32_t>(total + static_cast<std::uint32_t>(std::int32_t{since(total, counter)}));
  }

 private:
  [[nodiscard]] static std::int16_t since(std::uint32_t total, std::uint16_t counter) noexcept {
    return static_cast<std::int16_t>(static_cast<std::uint16_t>(counter - (total & 0xFFFF)));
  }

  std::atomic<std::uint32_t> total_{0};
  bool started_ = false;
};

}  // namespace ocm::firmware::drivers
