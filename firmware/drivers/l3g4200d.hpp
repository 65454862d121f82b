/// Gyroscope L3G4200D: +-500 deg/s, 800 samples/s, low-pass at 30 Hz. Cost and errors: st_motion.hpp.
/// [data sheet: ST L3G4200D, Doc ID 17116 Rev 3; AN3393: ST application note, Doc ID 018750 Rev 1]
#pragma once

#include <chrono>
#include <cstdint>

#include "ocm/base/time.hpp"

#include "firmware/boards/samples.hpp"
#include "firmware/drivers/bus.hpp"
#include "firmware/drivers/bytes.hpp"
#include "firmware/drivers/st_motion.hpp"

namespace ocm::firmware::drivers {

struct L3g4200dChip {
  using Sample = boards::AngularRate;

  static constexpr std::uint8_t identity = 0xD3;  ///< [data sheet 7.1]
  static constexpr st_motion::Control control{
      0xCF,  // DR 11: 800 Hz, BW 00: cut-off 30 Hz, PD 1: on, three axes [data sheet 7.2]
      0x00,  // no high-pass in use [7.3]
      0x00,  // no interrupts [7.4]
      0x90,  // BDU 1: no half-new samples; FS 01: 500 dps; little-endian, 4 wires [7.5]
      0x00,  // no FIFO, straight from the first filter [7.6]
  };
  /// From power-down to good samples. [AN3393 2.4]
  static constexpr base::Duration turn_on = std::chrono::milliseconds{300};

  /// 0.0175 deg/s a digit. [data sheet, table 4]
  [[nodiscard]] static constexpr Sample decode(st_motion::Output out) noexcept {
    return {join_signed(out[1], out[0]), join_signed(out[3], out[2]), join_signed(out[5], out[4])};
  }
};

template <Spi Device>
using L3g4200d = StMotion<Device, L3g4200dChip>;

}  // namespace ocm::firmware::drivers
