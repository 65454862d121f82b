/// What ST's gyroscope L3G4200D and accelerometer LIS331DLH have in common: the SPI protocol, the places of
/// identity, control and output registers, and so the driver. What differs is a `Chip`.
///
/// One frame of 15 bytes a sample, 12 us at 10 MHz. SPI cannot tell whether a part answers, so each frame
/// fetches the control registers too: a part that is away, or was reset, is noticed in the same frame.
/// Errors: no_answer, not this part or not as configured; what the bus says.
/// [data sheets: L3G4200D, ST Doc ID 17116 Rev 3; LIS331DLH, ST Doc ID 15094 Rev 3: section 5.2 of both]
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"

#include "firmware/drivers/bus.hpp"

namespace ocm::firmware::drivers {

namespace st_motion {

/// Clock idle high, data taken at the rising edge. [5.2] At most 10 MHz. [L3G4200D table 7, LIS331DLH table
/// 5]
inline constexpr SpiSettings spi{3, 10'000'000};
/// In the first byte of a frame: read; move on to the next register after each byte. [5.2.1, 5.2.2]
inline constexpr std::uint8_t read = 0x80;
inline constexpr std::uint8_t next = 0x40;

// Registers. [L3G4200D table 17, LIS331DLH table 16]
inline constexpr std::uint8_t who_am_i = 0x0F;
inline constexpr std::uint8_t ctrl_reg1 = 0x20;
inline constexpr std::uint8_t out_x_l = 0x28;
inline constexpr std::uint8_t out_z_h = 0x2D;

using Control = std::array<std::uint8_t, 5>;      ///< CTRL_REG1 to CTRL_REG5
using Output = std::span<const std::uint8_t, 6>;  ///< OUT_X_L to OUT_Z_H

}  // namespace st_motion

template <Spi Device, class Chip>
class StMotion {
 public:
  explicit StMotion(Device& device) noexcept : device_(&device) {}

  base::Result<base::Duration> start() {
    using namespace st_motion;
    const std::array<std::uint8_t, 2> ask{st_motion::read | who_am_i, 0};
    std::array<std::uint8_t, 2> answer{};
    if (const auto done = device_->transfer(spi, ask, answer); !done) return done.error;
    if (answer[1] != Chip::identity) return base::Error::no_answer;

    std::array<std::uint8_t, 1 + Chip::control.size()> write{next | ctrl_reg1};
    std::copy(Chip::control.begin(), Chip::control.end(), write.begin() + 1);
    std::array<std::uint8_t, 1 + Chip::control.size()> ignored{};
    if (const auto done = device_->transfer(spi, write, ignored); !done) return done.error;
    if (const auto done = check(); !done) return done.error;
    return Chip::turn_on;
  }

  base::Status check() {
    Frame frame{};
    return fetch(frame);
  }

  base::Result<typename Chip::Sample> read() {
    Frame frame{};
    if (const auto done = fetch(frame); !done) return done.error;
    return Chip::decode(std::span{frame}.template last<6>());
  }

 private:
  /// The address, then CTRL_REG1 to OUT_Z_H.
  using Frame = std::array<std::uint8_t, 1 + (st_motion::out_z_h - st_motion::ctrl_reg1 + 1)>;

  base::Status fetch(Frame& in) {
    using namespace st_motion;
    const Frame out{st_motion::read | next | ctrl_reg1};
    if (const auto done = device_->transfer(spi, out, in); !done) return done.error;
    const bool ours = std::equal(Chip::control.begin(), Chip::control.end(), in.begin() + 1);
    return ours ? base::Error::none : base::Error::no_answer;
  }

  Device* device_;
};

}  // namespace ocm::firmware::drivers
