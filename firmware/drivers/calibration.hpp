/// The offsets of a board's proximity sensors: measured on command, kept in the board's EEPROM across a
/// reset (record_store.hpp).
///
/// Nothing here waits: `step` does one read of a sensor or one transfer to the EEPROM a call.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"

#include "firmware/drivers/bus.hpp"
#include "firmware/drivers/record_store.hpp"

namespace ocm::firmware::drivers {

/// `Sensors` sensors' offsets, 8 at the most. As a `Part`'s driver, `start` fetches what is stored.
template <I2c Bus, std::size_t Sensors>
class Calibration {
 public:
  static_assert(Sensors > 0 && Sensors <= CalibrationRecord::most);
  using Offsets = std::array<std::uint16_t, Sensors>;

  /// Samples that one measurement is the mean of.
  static constexpr std::uint16_t samples = 16;

  explicit Calibration(Bus& bus) noexcept : store_(bus) {}

  /// Asks for a measurement, now and to be kept, or for all offsets to be 0. From any context. Error::full
  /// while one is under way; the outcome is `last()`.
  base::Status request(bool forget) noexcept {
    if (order_.load(std::memory_order_relaxed) != Order::none || busy()) return base::Error::full;
    order_.store(forget ? Order::forget : Order::measure, std::memory_order_release);
    return {};
  }

  /// The offset in use; 0 when there is none. From any context.
  [[nodiscard]] std::uint16_t offset(std::size_t sensor) const noexcept {
    return offsets_[sensor].load(std::memory_order_relaxed);
  }
  [[nodiscard]] bool busy() const noexcept {
    return doing_.load(std::memory_order_relaxed) != Doing::nothing ||
           order_.load(std::memory_order_relaxed) != Order::none;
  }
  /// How the last request ended: what is in use may not be what is stored.
  [[nodiscard]] base::Error last() const noexcept { return last_.load(std::memory_order_relaxed); }

  // --- what follows is for one context only ---

  /// Fetches what is stored, unless something was measured since. An EEPROM without a record is no error.
  base::Result<base::Duration> start() {
    const auto done = store_.load(Sensors, [this](const auto& offsets) {
      if (!changed_) use(offsets);
    });
    if (!done) return done.error;
    return base::Duration{0};
  }
  base::Status check() { return store_.ready(); }

  /// One step of what was asked for; nothing when nothing was. `read(sensor)` is a Result of its counts.
  template <class Read>
  void step(Read read) {
    switch (doing_.load(std::memory_order_relaxed)) {
      case Doing::nothing:
        return take();
      case Doing::measuring:
        return measure(read(sensor_));
      case Doing::writing:
        return write();
    }
  }

 private:
  enum class Order : std::uint8_t { none, measure, forget };
  enum class Doing : std::uint8_t { nothing, measuring, writing };

  void use(const std::array<std::uint16_t, CalibrationRecord::most>& offsets) noexcept {
    for (std::size_t i = 0; i < Sensors; ++i) offsets_[i].store(offsets[i], std::memory_order_relaxed);
  }
  void become(Doing doing) noexcept { doing_.store(doing, std::memory_order_relaxed); }
  void end(base::Error error) noexcept {
    last_.store(error, std::memory_order_relaxed);
    become(Doing::nothing);
  }

  void take() noexcept {
    const Order order = order_.load(std::memory_order_acquire);
    if (order == Order::none) return;
    sums_.fill(0);
    sensor_ = 0;
    taken_ = 0;
    if (order == Order::measure)
      become(Doing::measuring);
    else
      keep();
    order_.store(Order::none, std::memory_order_release);
  }

  void measure(const base::Result<std::uint16_t>& counts) noexcept {
    if (!counts) return end(counts.error);
    sums_[sensor_] += *counts;
    if (++sensor_ != Sensors) return;
    sensor_ = 0;
    if (++taken_ == samples) keep();
  }

  /// Takes the means, or the zeros, into use, and begins to write them into the older slot.
  void keep() noexcept {
    typename RecordStore<Bus>::Numbers means{};
    for (std::size_t i = 0; i < Sensors; ++i)
      means[i] = static_cast<std::uint16_t>((sums_[i] + samples / 2) / samples);
    use(means);
    changed_ = true;
    store_.begin(means, Sensors);
    become(Doing::writing);
  }

  void write() {
    if (store_.step()) end(store_.error());
  }

  RecordStore<Bus> store_;
  std::array<std::atomic<std::uint16_t>, Sensors> offsets_{};
  std::atomic<Order> order_{Order::none};
  std::atomic<Doing> doing_{Doing::nothing};
  std::atomic<base::Error> last_{base::Error::none};
  std::array<std::uint32_t, Sensors> sums_{};
  std::size_t sensor_ = 0;
  std::uint16_t taken_ = 0;
  bool changed_ = false;
};

}  // namespace ocm::firmware::drivers
