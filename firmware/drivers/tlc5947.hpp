/// LED driver TLC5947: 24 outputs of 12 bits, here eight coloured lights.
///
/// The chip select of its SPI device is the pin XLAT: data taken while it is low, used when it rises. 36
/// bytes, 16 us at 18 MHz. The part cannot be asked anything. Errors: those of the bus.
/// [data sheet: TI TLC5947, SBVS114B]
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/base/result.hpp"

#include "firmware/boards/samples.hpp"
#include "firmware/drivers/bus.hpp"

namespace ocm::firmware::drivers {

namespace tlc5947 {

/// Data taken at the rising edge of a clock that idles low. [data sheet, figure 20] At most 30 MHz for a part
/// that stands alone. [Recommended Operating Conditions: f(SCLK)]
inline constexpr SpiSettings spi{0, 30'000'000};

inline constexpr std::size_t outputs = 24;
inline constexpr std::size_t lights = 8;
using Frame = std::array<std::uint8_t, outputs * 12 / 8>;

/// 8 bits as 12: 0 is off, 255 is on all the time, and all between in equal steps.
[[nodiscard]] constexpr std::uint16_t gray(std::uint8_t level) noexcept {
  return static_cast<std::uint16_t>(level << 4 | level >> 4);
}
static_assert(gray(0) == 0 && gray(255) == 4095 && gray(128) == 2056);

/// What is shifted in: output 23 first, high bit first. [data sheet, Register Configuration]
[[nodiscard]] constexpr Frame pack(const std::array<std::uint16_t, outputs>& levels) noexcept {
  Frame frame{};
  for (std::size_t i = 0; i < outputs; i += 2) {
    const std::uint16_t first = levels[outputs - 1 - i];
    const std::uint16_t second = levels[outputs - 2 - i];
    std::uint8_t* bytes = frame.data() + i / 2 * 3;
    bytes[0] = static_cast<std::uint8_t>(first >> 4);
    bytes[1] = static_cast<std::uint8_t>((first & 0xF) << 4 | second >> 8);
    bytes[2] = static_cast<std::uint8_t>(second & 0xFF);
  }
  return frame;
}

/// Light 0 is on outputs 23 (blue), 22 (green), 21 (red), light 1 on the next three. [AMiRo-OS 1.0,
/// tlc5947.cpp; it dims blue to 3/4, here a colour is what the frame says]
[[nodiscard]] constexpr Frame pack(const std::array<boards::Colour, lights>& colours) noexcept {
  std::array<std::uint16_t, outputs> levels{};
  for (std::size_t i = 0; i < lights; ++i) {
    levels[outputs - 1 - 3 * i] = gray(colours[i].blue);
    levels[outputs - 2 - 3 * i] = gray(colours[i].green);
    levels[outputs - 3 - 3 * i] = gray(colours[i].red);
  }
  return pack(levels);
}

}  // namespace tlc5947

template <Spi Device>
class Tlc5947 {
 public:
  explicit Tlc5947(Device& device) noexcept : device_(&device) {}

  base::Status show(const std::array<boards::Colour, tlc5947::lights>& colours) {
    const tlc5947::Frame out = tlc5947::pack(colours);
    tlc5947::Frame in{};  // the part's output is not connected
    return device_->transfer(tlc5947::spi, out, in);
  }

 private:
  Device* device_;
};

}  // namespace ocm::firmware::drivers
