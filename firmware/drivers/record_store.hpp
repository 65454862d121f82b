/// Some numbers that a board keeps across a reset, in its EEPROM: checked when they are read again.
///
/// Two slots are written in turn, so that power that fails while one is written leaves the other. A record
/// counts only when all of it fits: mark, version, how many numbers, CRC. AMiRo-OS keeps plain words at
/// 0x14; they stay as they are. [AMiRo-OS 1.0, FSIODiWheelDrive.hpp]
///
/// Nothing here waits: `step` does one transfer to the EEPROM a call. One context only.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "ocm/base/crc16.hpp"
#include "ocm/base/result.hpp"

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

template <I2c Bus>
class RecordStore {
 public:
  using Numbers = std::array<std::uint16_t, CalibrationRecord::most>;
  /// A page that is not accepted so many calls in a row is given up. At one call in 10 ms, 5 ms are one.
  static constexpr std::uint8_t most_tries = 10;

  explicit RecordStore(Bus& bus) noexcept : eeprom_(bus) {}

  /// Each record of so many numbers, the newest last: `found(numbers)`. None is no error.
  template <class Found>
  base::Status load(std::uint8_t count, Found found) {
    bool any = false;
    stored_ = 0;
    for (std::size_t slot = 0; slot < 2; ++slot) {
      CalibrationRecord::Bytes bytes{};
      if (const auto done = eeprom_.read(calibration_slots[slot], bytes); !done) return done;
      const auto record = decode(bytes);
      if (!record || record->count != count || (any && !later(record->sequence, sequence_))) continue;
      any = true;
      stored_ = slot;
      sequence_ = record->sequence;
      found(record->offsets);
    }
    return {};
  }
  base::Status ready() { return eeprom_.ready(); }

  /// `step` will write these into the older slot.
  void begin(const Numbers& numbers, std::uint8_t count) noexcept {
    image_ = encode({.sequence = ++sequence_, .count = count, .offsets = numbers});
    page_ = 0;
    tries_ = 0;
  }
  /// A page, or all of it read again. True: that was the last step, and `error` is how it ended.
  bool step() {
    const base::Status done = page_ == pages ? verify() : write();
    if (done) return page_ > pages;
    error_ = done.error;
    return ++tries_ == most_tries;  // else busy with the page before, or away
  }
  [[nodiscard]] base::Error error() const noexcept { return error_; }

 private:
  static constexpr std::size_t pages = CalibrationRecord::size / at24c01b::page;

  [[nodiscard]] std::uint8_t slot() const noexcept { return calibration_slots[1 - stored_]; }

  base::Status write() {
    const std::size_t first = page_ * at24c01b::page;
    const auto bytes = std::span<const std::uint8_t>{image_}.subspan(first, at24c01b::page);
    const auto done = eeprom_.write(static_cast<std::uint8_t>(slot() + first), bytes);
    if (done) ++page_, tries_ = 0;
    return done;
  }
  base::Status verify() {
    CalibrationRecord::Bytes bytes{};
    if (const auto done = eeprom_.read(slot(), bytes); !done) return done;
    if (bytes != image_) {
      tries_ = most_tries - 1;  // once more would read the same
      return base::Error::bus_fault;
    }
    stored_ = 1 - stored_;
    ++page_;
    error_ = base::Error::none;
    return {};
  }

  At24c01b<Bus> eeprom_;
  CalibrationRecord::Bytes image_{};
  std::size_t page_ = 0;
  std::size_t stored_ = 0;  // the slot that holds the newest record
  std::uint8_t sequence_ = 0;
  std::uint8_t tries_ = 0;
  base::Error error_ = base::Error::none;
};

}  // namespace ocm::firmware::drivers
