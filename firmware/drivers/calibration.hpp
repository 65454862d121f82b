/// The offsets of a board's proximity sensors: measured on command, kept in the board's EEPROM across a
/// reset, checked when they are read again.
///
/// Two slots are written in turn, so that power that fails while one is written leaves the other. A record
/// counts only when all of it fits: mark, version, number of offsets, CRC. AMiRo-OS keeps plain words at
/// 0x14; they stay as they are. [AMiRo-OS 1.0, FSIODiWheelDrive.hpp]
///
/// Nothing here waits: `step` does one read of a sensor or one transfer to the EEPROM a call.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "ocm/base/crc16.hpp"
#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"

#include "firmware/drivers/at24c01b.hpp"
#include "firmware/drivers/bus.hpp"
#include "firmware/drivers/bytes.hpp"

namespace ocm::firmware::drivers {

/// What a slot holds.
struct CalibrationRecord {
  static constexpr std::size_t most = 8;   ///< offsets
  static constexpr std::size_t size = 24;  ///< bytes: three pages
  using Bytes = std::array<std::uint8_t, size>;

  std::uint8_t sequence = 0;  ///< one more with each record; wraps
  std::uint8_t count = 0;     ///< offsets in use
  std::array<std::uint16_t, most> offsets{};
  friend constexpr bool operator==(const CalibrationRecord&, const CalibrationRecord&) = default;
};

/// 'O' 'C', version 1, sequence, count, 0, eight offsets, CRC of all that; words low byte first.
[[nodiscard]] constexpr CalibrationRecord::Bytes encode(const CalibrationRecord& record) noexcept {
  CalibrationRecord::Bytes bytes{'O', 'C', 1, record.sequence, record.count, 0};
  for (std::size_t i = 0; i < CalibrationRecord::most; ++i) {
    bytes[6 + 2 * i] = low_byte(record.offsets[i]);
    bytes[7 + 2 * i] = high_byte(record.offsets[i]);
  }
  const std::uint16_t crc = base::crc16(std::span{bytes}.first<22>());
  bytes[22] = low_byte(crc);
  bytes[23] = high_byte(crc);
  return bytes;
}

/// Nothing when the bytes are not a record, or not a whole one.
[[nodiscard]] constexpr std::optional<CalibrationRecord> decode(
    std::span<const std::uint8_t, CalibrationRecord::size> bytes) noexcept {
  CalibrationRecord record;
  record.sequence = bytes[3];
  record.count = bytes[4];
  for (std::size_t i = 0; i < CalibrationRecord::most; ++i)
    record.offsets[i] = join(bytes[7 + 2 * i], bytes[6 + 2 * i]);
  const CalibrationRecord::Bytes same = encode(record);
  if (!std::equal(same.begin(), same.end(), bytes.begin())) return std::nullopt;
  return record;
}

/// Where the two slots are: in what AMiRo-OS leaves for general use. [FSIODiWheelDrive.hpp: 0x34 to 0x7B]
inline constexpr std::array<std::uint8_t, 2> calibration_slots{0x40, 0x58};
static_assert(calibration_slots[0] % at24c01b::page == 0 && calibration_slots[1] % at24c01b::page == 0);
static_assert(calibration_slots[0] + CalibrationRecord::size == calibration_slots[1]);
static_assert(calibration_slots[1] + CalibrationRecord::size <= 0x7C);

/// Which of two sequence numbers is the later one, across the wrap.
[[nodiscard]] constexpr bool later(std::uint8_t a, std::uint8_t b) noexcept {
  return static_cast<std::int8_t>(static_cast<std::uint8_t>(a - b)) > 0;
}

/// `Sensors` sensors' offsets, 8 at the most. As a `Part`'s driver, `start` fetches what is stored.
template <I2c Bus, std::size_t Sensors>
class Calibration {
 public:
  static_assert(Sensors > 0 && Sensors <= CalibrationRecord::most);
  using Offsets = std::array<std::uint16_t, Sensors>;

  /// Samples that one measurement is the mean of.
  static constexpr std::uint16_t samples = 16;
  /// A page that is not accepted so many calls in a row is given up. At one call in 10 ms, 5 ms are one.
  static constexpr std::uint8_t most_tries = 10;

  explicit Calibration(Bus& bus) noexcept : eeprom_(bus) {}

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
    std::array<std::optional<CalibrationRecord>, 2> found;
    for (std::size_t slot = 0; slot < 2; ++slot) {
      CalibrationRecord::Bytes bytes{};
      if (const auto done = eeprom_.read(calibration_slots[slot], bytes); !done) return done.error;
      found[slot] = decode(bytes);
      if (found[slot] && found[slot]->count != Sensors) found[slot].reset();
    }
    const bool second = found[1] && (!found[0] || later(found[1]->sequence, found[0]->sequence));
    stored_ = second ? 1 : 0;
    if (found[stored_]) {
      sequence_ = found[stored_]->sequence;
      if (!changed_) use(found[stored_]->offsets);
    }
    return base::Duration{0};
  }
  base::Status check() { return eeprom_.ready(); }

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
      case Doing::verifying:
        return verify();
    }
  }

 private:
  enum class Order : std::uint8_t { none, measure, forget };
  enum class Doing : std::uint8_t { nothing, measuring, writing, verifying };
  static constexpr std::size_t pages = CalibrationRecord::size / at24c01b::page;

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
    CalibrationRecord record;
    record.sequence = ++sequence_;
    record.count = Sensors;
    for (std::size_t i = 0; i < Sensors; ++i)
      record.offsets[i] = static_cast<std::uint16_t>((sums_[i] + samples / 2) / samples);
    use(record.offsets);
    changed_ = true;
    image_ = encode(record);
    page_ = 0;
    tries_ = 0;
    become(Doing::writing);
  }

  [[nodiscard]] std::uint8_t slot() const noexcept { return calibration_slots[1 - stored_]; }

  void write() {
    const std::size_t first = page_ * at24c01b::page;
    const auto bytes = std::span<const std::uint8_t>{image_}.subspan(first, at24c01b::page);
    const auto done = eeprom_.write(static_cast<std::uint8_t>(slot() + first), bytes);
    if (!done) return again(done.error);
    tries_ = 0;
    if (++page_ == pages) become(Doing::verifying);
  }

  void verify() {
    CalibrationRecord::Bytes bytes{};
    const auto done = eeprom_.read(slot(), bytes);
    if (!done) return again(done.error);
    if (bytes != image_) return end(base::Error::bus_fault);
    stored_ = 1 - stored_;
    end(base::Error::none);
  }

  /// Not acknowledged: still busy with the page before, or away.
  void again(base::Error error) noexcept {
    if (++tries_ == most_tries) end(error);
  }

  At24c01b<Bus> eeprom_;
  std::array<std::atomic<std::uint16_t>, Sensors> offsets_{};
  std::atomic<Order> order_{Order::none};
  std::atomic<Doing> doing_{Doing::nothing};
  std::atomic<base::Error> last_{base::Error::none};
  std::array<std::uint32_t, Sensors> sums_{};
  CalibrationRecord::Bytes image_{};
  std::size_t sensor_ = 0;
  std::size_t page_ = 0;
  std::size_t stored_ = 0;  // the slot that holds the newest record
  std::uint16_t taken_ = 0;
  std::uint8_t sequence_ = 0;
  std::uint8_t tries_ = 0;
  bool changed_ = false;
};

}  // namespace ocm::firmware::drivers
