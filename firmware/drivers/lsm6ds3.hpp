/// Gyroscope of the LSM6DS3 on SPI: +-500 deg/s, 208 samples/s; its accelerometer stays off.
///
/// One frame of 24 bytes a sample, 20 us at 10 MHz. SPI cannot tell whether a part answers, so each frame
/// fetches the control registers too: a part that is away, or was reset, is noticed in the same frame.
/// Errors: no_answer, not this part or not as configured; what the bus says. [data sheet: ST LSM6DS3,
/// DocID026899 Rev 8; AN4650: ST application note, DocID027415 Rev 5]
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"

#include "firmware/boards/samples.hpp"
#include "firmware/drivers/bus.hpp"
#include "firmware/drivers/bytes.hpp"

namespace ocm::firmware::drivers {

namespace lsm6ds3 {

/// Clock idle high, data taken at the rising edge; at most 10 MHz. [data sheet 6.2, table 7]
inline constexpr SpiSettings spi{3, 10'000'000};
inline constexpr std::uint8_t reading = 0x80;  ///< in the first byte of a frame [6.2.1]

// Registers. [data sheet, table 16]
inline constexpr std::uint8_t who_am_i = 0x0F;
inline constexpr std::uint8_t ctrl2_g = 0x11;
inline constexpr std::uint8_t ctrl3_c = 0x12;
inline constexpr std::uint8_t outx_l_g = 0x22;
inline constexpr std::uint8_t outz_h_g = 0x27;

inline constexpr std::uint8_t identity = 0x69;  ///< [9.11]

/// CTRL2_G: ODR 0101, 208 Hz; FS 01, 500 dps. CTRL3_C: BDU, no half-new samples; IF_INC, on to the next
/// register after each byte. [9.13, 9.14]
inline constexpr std::array<std::uint8_t, 2> control{0x54, 0x44};

/// From power-down to good samples. [AN4650 table 16: 80 ms at the most]
inline constexpr base::Duration turn_on = std::chrono::milliseconds{80};

/// Three words, low byte first: x, y, z; 0.0175 deg/s a digit. [data sheet, table 3: 17.50 mdps at 500 dps]
[[nodiscard]] constexpr boards::AngularRate decode(std::span<const std::uint8_t, 6> out) noexcept {
  return {join_signed(out[1], out[0]), join_signed(out[3], out[2]), join_signed(out[5], out[4])};
}

}  // namespace lsm6ds3

template <Spi Device>
class Lsm6ds3 {
 public:
  explicit Lsm6ds3(Device& device) noexcept : device_(&device) {}

  base::Result<base::Duration> start() {
    using namespace lsm6ds3;
    std::array<std::uint8_t, 2> in{};
    if (const auto done = transfer(std::array{std::uint8_t{reading | who_am_i}, std::uint8_t{0}}, in); !done)
      return done.error;
    if (in[1] != identity) return base::Error::no_answer;
    // The increment first: without it the other frames would stay at their first register.
    if (const auto done = transfer(std::array{ctrl3_c, control[1]}, in); !done) return done.error;
    if (const auto done = transfer(std::array{ctrl2_g, control[0]}, in); !done) return done.error;
    if (const auto done = check(); !done) return done.error;
    return turn_on;
  }

  base::Status check() {
    Frame in{};
    return fetch(in);
  }

  base::Result<boards::AngularRate> read() {
    Frame in{};
    if (const auto done = fetch(in); !done) return done.error;
    return lsm6ds3::decode(std::span{in}.template last<6>());
  }

 private:
  /// The address, then CTRL2_G to OUTZ_H_G.
  using Frame = std::array<std::uint8_t, 1 + (lsm6ds3::outz_h_g - lsm6ds3::ctrl2_g + 1)>;

  base::Status transfer(std::span<const std::uint8_t> out, std::span<std::uint8_t> in) {
    return device_->transfer(lsm6ds3::spi, out, in);
  }
  base::Status fetch(Frame& in) {
    using namespace lsm6ds3;
    const Frame out{reading | ctrl2_g};
    if (const auto done = transfer(out, in); !done) return done.error;
    const bool ours = std::equal(control.begin(), control.end(), in.begin() + 1);
    return ours ? base::Error::none : base::Error::no_answer;
  }

  Device* device_;
};

}  // namespace ocm::firmware::drivers
