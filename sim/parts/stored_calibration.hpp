/// Offsets in an EEPROM, as a calibration leaves them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/drivers/calibration.hpp"
#include "sim/parts/at24c01b_model.hpp"

namespace ocm::sim {

/// Puts a calibration record where the firmware looks for it.
template <std::size_t N>
void store_calibration(At24c01bModel& eeprom, const std::array<std::uint16_t, N>& offsets) {
  firmware::drivers::CalibrationRecord record;
  record.count = N;
  std::copy(offsets.begin(), offsets.end(), record.offsets.begin());
  const auto bytes = firmware::drivers::encode(record);
  std::copy(bytes.begin(), bytes.end(), eeprom.bytes().begin() + firmware::drivers::calibration_slots[0]);
}

}  // namespace ocm::sim
