/// Magnetometer HMC5883L on I2C: +-4.7 G, 75 samples/s, each the mean of 8.
///
/// 9 bytes on the bus a sample, 0.25 ms at 400 kbit/s. Errors: no_answer, not acknowledged, not this part or
/// not as configured; bus_fault; not_sampled, the field is stronger than the range.
/// [data sheet: Honeywell HMC5883L, form 900405 Rev E]
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <initializer_list>
#include <span>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"

#include "firmware/boards/samples.hpp"
#include "firmware/drivers/bus.hpp"
#include "firmware/drivers/bytes.hpp"

namespace ocm::firmware::drivers {

namespace hmc5883l {

inline constexpr std::uint8_t address = 0x1E;  ///< [data sheet, Register Access]

// Registers. [data sheet, table 2]
inline constexpr std::uint8_t configuration_a = 0;
inline constexpr std::uint8_t configuration_b = 1;
inline constexpr std::uint8_t mode = 2;
inline constexpr std::uint8_t data_x_msb = 3;
inline constexpr std::uint8_t identification_a = 10;

inline constexpr std::array<std::uint8_t, 3> identity{'H', '4', '3'};  ///< [data sheet, tables 18 to 20]

inline constexpr std::uint8_t eight_samples_75_hz = 0x78;  ///< MA 11, DO 110, MS 00 [tables 3 to 6]
inline constexpr std::uint8_t gain_5 = 0xA0;               ///< GN 101: 390 counts/G, +-4.7 G [table 9]
inline constexpr std::uint8_t continuous = 0x00;           ///< MD 00 [table 12]

/// Ready to be read after power-up; also three periods of 75 Hz, after which no sample is of the old gain.
/// [data sheet, Operational Examples: 56 ms]
inline constexpr base::Duration turn_on = std::chrono::milliseconds{56};

inline constexpr std::int32_t microgauss_per_count = 2560;  ///< at gain 5 [data sheet, table 9: 2.56 mG/LSb]
inline constexpr std::int16_t overflow = -4096;             ///< [data sheet, Data Output X Registers]
inline constexpr std::int16_t lowest = -2048;               ///< 12 bits, sign extended [the same]
inline constexpr std::int16_t highest = 2047;

/// Six bytes from `data_x_msb` on: x, z, y, high byte first. [data sheet, table 2] Error::not_sampled: too
/// strong a field; Error::bus_fault: bytes that no part sends.
[[nodiscard]] constexpr base::Result<boards::MagneticField> decode(
    std::span<const std::uint8_t, 6> data) noexcept {
  const std::int16_t x = join_signed(data[0], data[1]);
  const std::int16_t z = join_signed(data[2], data[3]);
  const std::int16_t y = join_signed(data[4], data[5]);
  if (x == overflow || y == overflow || z == overflow) return base::Error::not_sampled;
  for (const std::int16_t count : {x, y, z})
    if (count < lowest || count > highest) return base::Error::bus_fault;
  return boards::MagneticField{x * microgauss_per_count, y * microgauss_per_count, z * microgauss_per_count};
}

}  // namespace hmc5883l

template <I2c Bus>
class Hmc5883l {
 public:
  explicit Hmc5883l(Bus& bus) noexcept : bus_(&bus) {}

  base::Result<base::Duration> start() {
    using namespace hmc5883l;
    std::array<std::uint8_t, 3> who{};
    if (const auto done = fetch(identification_a, who); !done) return done.error;
    if (who != identity) return base::Error::no_answer;
    // One register a transfer, as the data sheet's examples write them: it promises no increment on writing.
    if (const auto done = write(configuration_a, eight_samples_75_hz); !done) return done.error;
    if (const auto done = write(configuration_b, gain_5); !done) return done.error;
    if (const auto done = write(mode, continuous); !done) return done.error;
    return turn_on;
  }

  /// Not the mode register: reading it locks the outputs until all six are read. [data sheet, table 17]
  base::Status check() {
    using namespace hmc5883l;
    std::array<std::uint8_t, 2> configuration{};
    if (const auto done = fetch(configuration_a, configuration); !done) return done.error;
    const bool ours = configuration == std::array<std::uint8_t, 2>{eight_samples_75_hz, gain_5};
    return ours ? base::Error::none : base::Error::no_answer;
  }

  /// Error::not_sampled when the field is stronger than the range.
  base::Result<boards::MagneticField> read() {
    std::array<std::uint8_t, 6> data{};
    if (const auto done = fetch(hmc5883l::data_x_msb, data); !done) return done.error;
    return hmc5883l::decode(data);
  }

 private:
  base::Status fetch(std::uint8_t first, std::span<std::uint8_t> registers) {
    const std::array<std::uint8_t, 1> pointer{first};
    return bus_->transfer(hmc5883l::address, pointer, registers);
  }
  base::Status write(std::uint8_t where, std::uint8_t what) {
    const std::array<std::uint8_t, 2> bytes{where, what};
    return bus_->transfer(hmc5883l::address, bytes, {});
  }

  Bus* bus_;
};

}  // namespace ocm::firmware::drivers
