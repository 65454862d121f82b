/// Infrared distance sensor GP2Y0A21YK behind a channel of an analogue-to-digital converter: volts. What they
/// say in centimetres is ocm/sensing/ir_sensor.hpp.
///
/// One conversion a reading; the sensor itself measures each 38 ms and holds its output meanwhile. [data
/// sheet: Sharp GP2Y0A21YK, OP13008EN, timing chart] It cannot be asked whether it is there: a line without a
/// sensor reads as something.
#pragma once

#include <cstdint>

#include "ocm/base/result.hpp"
#include "ocm/sensing/ir_sensor.hpp"

#include "firmware/drivers/bus.hpp"

namespace ocm::firmware::drivers {

/// How wide a converter's counts are, and what its full scale is.
struct ConverterScale {
  unsigned bits = 10;
  float reference_v = 5.0F;
};

template <Converter C>
class Gp2y0a21yk {
 public:
  Gp2y0a21yk(C& converter, std::uint8_t channel, ConverterScale scale) noexcept
      : converter_(&converter), scale_(scale), channel_(channel) {}

  /// Volts; the converter's error. Error::bus_fault: a count that it does not have.
  base::Result<float> read() {
    const auto count = converter_->convert(channel_);
    if (!count) return count.error;
    if (*count >> scale_.bits != 0) return base::Error::bus_fault;
    return sensing::adc_volts(*count, scale_.bits, scale_.reference_v);
  }

 private:
  C* converter_;
  ConverterScale scale_;
  std::uint8_t channel_;
};

}  // namespace ocm::firmware::drivers
