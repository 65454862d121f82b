/// Accelerometer LIS331DLH: +-4 g as AMiRo-OS has it, 1000 samples/s. Cost and errors: st_motion.hpp.
///
/// The part has 12 bits: at +-4 g a digit is 1/512 g, so every number in 1/1024 g is even, as all of those in
/// the thesis's log are.
/// [data sheet: ST LIS331DLH, Doc ID 15094 Rev 3]
#pragma once

#include <chrono>
#include <cstdint>

#include "ocm/base/time.hpp"

#include "firmware/boards/samples.hpp"
#include "firmware/drivers/bus.hpp"
#include "firmware/drivers/bytes.hpp"
#include "firmware/drivers/st_motion.hpp"

namespace ocm::firmware::drivers {

struct Lis331dlhChip {
  using Sample = boards::SpecificForce;

  static constexpr std::uint8_t identity = 0x32;  ///< [data sheet 7.1]
  static constexpr st_motion::Control control{
      0x3F,  // PM 001: normal mode, DR 11: 1000 Hz, low-pass 780 Hz, three axes [data sheet 7.2]
      0x00,  // no high-pass in use [7.3]
      0x00,  // no interrupts [7.4]
      0x90,  // BDU 1: no half-new samples; FS 01: 4 g; little-endian, 4 wires [7.5; AMiRo-OS: FS_4G]
      0x00,  // no sleep-to-wake [7.6]
  };
  /// 1/ODR + 1 ms. [data sheet, table 4]
  static constexpr base::Duration turn_on = std::chrono::milliseconds{2};

  /// One axis in 1/1024 g: 12 bits, left-justified, 4 g / 2048 each. [data sheet 2.1, 3.2]
  [[nodiscard]] static constexpr std::int16_t force(std::uint8_t high, std::uint8_t low) noexcept {
    return static_cast<std::int16_t>((join_signed(high, low) >> 4) * 2);
  }
  [[nodiscard]] static constexpr Sample decode(st_motion::Output out) noexcept {
    return {force(out[1], out[0]), force(out[3], out[2]), force(out[5], out[4])};
  }
};

template <Spi Device>
using Lis331dlh = StMotion<Device, Lis331dlhChip>;

}  // namespace ocm::firmware::drivers
