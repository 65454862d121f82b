/// A request on the parts' line of an emulated board (firmware/qemu/parts_frames.hpp) as a transfer on a
/// model.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/base/result.hpp"

#include "firmware/qemu/parts_frames.hpp"
#include "sim/parts/i2c_bus.hpp"
#include "sim/parts/spi_device.hpp"

namespace ocm::sim {

/// Two bytes of what a request carries, the low one first.
[[nodiscard]] inline std::uint16_t word_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8);
}

[[nodiscard]] inline base::Status transfer(I2cBus& bus, const firmware::qemu::link::Request& request,
                                           std::span<std::uint8_t> read) {
  return bus.transfer(request.a, request.written, read);
}

/// Error::bad_length: no clock, or not as many bytes out as in.
[[nodiscard]] inline base::Status transfer(SpiDevice& device, const firmware::qemu::link::Request& request,
                                           std::span<std::uint8_t> read) {
  const auto written = request.written;
  if (written.size() < 4 || written.size() - 4 != read.size()) return base::Error::bad_length;
  const std::uint32_t clock_hz = word_at(written, 0) | std::uint32_t{word_at(written, 2)} << 16;
  return device.transfer({request.a, clock_hz}, written.subspan(4), read);
}

}  // namespace ocm::sim
