/// A mapper's compass calibration in an EEPROM (record_store.hpp): what the application asks of its parts
/// with `store` and `stored`.
///
/// A tenth of a milligauss and a hundredth of a degree: far below what a turn finds. Nothing here waits:
/// `step` does one transfer a call.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/motion/angle.hpp"
#include "ocm/motion/real.hpp"
#include "ocm/sensing/compass_calibration.hpp"

#include "firmware/drivers/bus.hpp"
#include "firmware/drivers/record_store.hpp"

namespace ocm::firmware::drivers {

namespace compass_memory {

inline constexpr std::uint8_t numbers = 4;  ///< offset x, y; field; error
inline constexpr float per_gauss = 1e4F;
inline constexpr float per_degree = 100.0F;

using Numbers = std::array<std::uint16_t, CalibrationRecord::most>;

/// The nearest; of what is no number: 0.
[[nodiscard]] constexpr std::int16_t rounded(float value) noexcept {
  if (!motion::is_finite(value)) return 0;
  const float within = motion::clamp(value, -32767.0F, 32767.0F);
  return static_cast<std::int16_t>(within + (within < 0.0F ? -0.5F : 0.5F));
}
[[nodiscard]] constexpr Numbers words(const sensing::CompassFit& fit) noexcept {
  const auto word = [](float value) { return static_cast<std::uint16_t>(rounded(value)); };
  return {word(fit.offset.x * per_gauss), word(fit.offset.y * per_gauss), word(fit.field * per_gauss),
          word(motion::degrees(fit.error_rad) * per_degree)};
}
[[nodiscard]] constexpr sensing::CompassFit fit(const Numbers& words) noexcept {
  const auto value = [](std::uint16_t word) { return static_cast<float>(static_cast<std::int16_t>(word)); };
  return {.offset = {value(words[0]) / per_gauss, value(words[1]) / per_gauss},
          .field = value(words[2]) / per_gauss,
          .error_rad = motion::radians(value(words[3]) / per_degree)};
}

}  // namespace compass_memory

/// As a `Part`'s driver, `start` fetches what is stored.
template <I2c Bus>
class CompassMemory {
 public:
  explicit CompassMemory(Bus& bus) noexcept : store_(bus) {}

  /// To be kept, in place of what was. From one context, which may preempt that of `step`.
  void store(const sensing::CompassFit& fit) noexcept {
    known_.store(false, std::memory_order_relaxed);
    order_ = fit;
    orders_.store(static_cast<std::uint8_t>(orders_.load(std::memory_order_relaxed) + 1),
                  std::memory_order_release);
  }
  /// What is kept, as it was given; Error::not_sampled: nothing, or not yet. From the same context.
  [[nodiscard]] base::Result<sensing::CompassFit> stored() const noexcept {
    if (!known_.load(std::memory_order_acquire)) return base::Error::not_sampled;
    return kept_;
  }

  // --- what follows is for the other context only ---

  [[nodiscard]] bool busy() const noexcept {
    return writing_ || orders_.load(std::memory_order_acquire) != taken_;
  }
  /// Fetches what is stored. An EEPROM without a record is no error.
  base::Result<base::Duration> start() {
    const auto done = store_.load(compass_memory::numbers, [this](const compass_memory::Numbers& words) {
      if (!busy()) know(compass_memory::fit(words));
    });
    if (!done) return done.error;
    return base::Duration{0};
  }
  base::Status check() { return store_.ready(); }
  /// One step of what was asked for. What could not be written stays unknown.
  void step() {
    if (!writing_) return take();
    if (!store_.step()) return;
    writing_ = false;
    if (store_.error() == base::Error::none) know(written_);
  }

 private:
  void take() noexcept {
    const std::uint8_t orders = orders_.load(std::memory_order_acquire);
    if (orders == taken_) return;
    written_ = order_;
    if (orders_.load(std::memory_order_acquire) != orders) return;  // a newer one: in the next step
    taken_ = orders;
    writing_ = true;
    store_.begin(compass_memory::words(written_), compass_memory::numbers);
  }
  void know(const sensing::CompassFit& fit) noexcept {
    known_.store(false, std::memory_order_relaxed);
    kept_ = fit;
    known_.store(true, std::memory_order_release);
  }

  RecordStore<Bus> store_;
  sensing::CompassFit order_{};
  sensing::CompassFit written_{};
  sensing::CompassFit kept_{};
  std::atomic<std::uint8_t> orders_{0};
  std::uint8_t taken_ = 0;
  std::atomic<bool> known_{false};
  bool writing_ = false;
};

}  // namespace ocm::firmware::drivers
