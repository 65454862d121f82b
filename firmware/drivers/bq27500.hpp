/// Fuel gauge BQ27500 on I2C, one a battery, and how two batteries are one.
///
/// Four reads a sample of either kind, 22 bytes on the bus: 2.5 ms at 100 kbit/s (400 would need a pause of
/// 66 us between two transfers [data sheet, I2C timing: t(BUF)]). Errors: no_answer, not acknowledged or not
/// this part; bus_fault. [data sheet: TI bq27500, SLUS785D; its table 4-1 has milliwatts where SLUS785 of
/// 2007 had 10 mW]
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"

#include "firmware/boards/samples.hpp"
#include "firmware/drivers/bus.hpp"
#include "firmware/drivers/bytes.hpp"

namespace ocm::firmware::drivers {

namespace bq27500 {

inline constexpr std::uint8_t address = 0x55;  ///< [data sheet 7.1: 0xAA to write, 0xAB to read]

// Commands, two bytes each, low byte first. [data sheet, table 4-1]
inline constexpr std::uint8_t control = 0x00;
inline constexpr std::uint8_t temperature = 0x06;  ///< 0.1 K; then the voltage, mV
inline constexpr std::uint8_t flags = 0x0A;
inline constexpr std::uint8_t remaining_capacity = 0x10;  ///< mAh, at the present load
inline constexpr std::uint8_t average_current = 0x14;     ///< mA, negative: discharging
inline constexpr std::uint8_t time_to_empty = 0x16;       ///< minutes; then time to full
inline constexpr std::uint8_t average_power = 0x24;       ///< mW, negative: discharging
inline constexpr std::uint8_t state_of_charge = 0x2C;

inline constexpr std::uint16_t device_type = 0x0001;  ///< subcommand of control [table 4-2]
inline constexpr std::uint16_t identity = 0x0500;     ///< its answer [4.1.1.1.2]

// Flags. [data sheet, table 4-4]
inline constexpr std::uint16_t fully_charged = 0x0200;     ///< FC
inline constexpr std::uint16_t battery_detected = 0x0008;  ///< BAT_DET

inline constexpr std::uint16_t unknown_minutes = 65535;  ///< [data sheet, TimeToEmpty, TimeToFull]

/// What one gauge says of its battery.
struct Battery {
  bool present = false;
  bool full = false;
  std::uint16_t minutes_to_empty = unknown_minutes;
  std::uint16_t minutes_to_full = unknown_minutes;
  std::int16_t power_mw = 0;
  std::uint8_t state_of_charge_percent = 0;
  friend constexpr bool operator==(const Battery&, const Battery&) = default;
};

namespace detail {
/// The rule for one that knows and one that does not.
template <class F>
[[nodiscard]] constexpr std::uint16_t known(std::uint16_t a, std::uint16_t b, F both) noexcept {
  if (a == unknown_minutes) return b;
  return b == unknown_minutes ? a : both(a, b);
}
}  // namespace detail

/// Two batteries as the topic has them. A battery that is not inserted counts for nothing.
/// - power: the sum, signed [AMiRo-OS: half of it; the load draws from both]
/// - state of charge: the mean, rounded down [AMiRo-OS]
/// - charging: plugged in, neither gauge foresees its battery empty, and not both are full [AMiRo-OS]
/// - minutes while charging: the longer time to full; the charger serves both at once [AMiRo-OS]
/// - minutes otherwise: the mean; what one has left when the other is empty lasts half as long [AMiRo-OS]
/// - a time that one gauge does not know is the other's, not part of a mean [AMiRo-OS: the mean with 65535,
///   which is the 32806 of the thesis's figure 6.3]
[[nodiscard]] constexpr boards::GaugeReading combine(const Battery& a, const Battery& b,
                                                     bool plugged) noexcept {
  boards::GaugeReading reading;
  reading.plugged = plugged;
  if (!a.present && !b.present) return reading;
  const Battery& first = a.present ? a : b;
  const Battery& second = b.present ? b : a;
  const bool two = a.present && b.present;
  reading.state_of_charge_percent =
      static_cast<std::uint8_t>((first.state_of_charge_percent + second.state_of_charge_percent) / 2);
  const std::int32_t power = first.power_mw + (two ? second.power_mw : 0);
  reading.power_mw = static_cast<std::int16_t>(std::clamp<std::int32_t>(power, -32768, 32767));
  reading.charging = plugged && !(first.full && second.full) && first.minutes_to_empty == unknown_minutes &&
                     second.minutes_to_empty == unknown_minutes;
  if (reading.charging)
    reading.minutes = detail::known(first.minutes_to_full, second.minutes_to_full,
                                    [](std::uint16_t x, std::uint16_t y) { return std::max(x, y); });
  else
    reading.minutes =
        detail::known(first.minutes_to_empty, second.minutes_to_empty, [](std::uint16_t x, std::uint16_t y) {
          return static_cast<std::uint16_t>((std::uint32_t{x} + y) / 2);
        });
  return reading;
}

}  // namespace bq27500

template <I2c Bus>
class Bq27500 {
 public:
  explicit Bq27500(Bus& bus) noexcept : bus_(&bus) {}

  /// It measures by itself, from its battery's insertion on.
  base::Result<base::Duration> start() {
    if (const auto done = check(); !done) return done.error;
    return base::Duration{0};
  }

  base::Status check() {
    using namespace bq27500;
    const std::array<std::uint8_t, 3> ask{control, low_byte(device_type), high_byte(device_type)};
    if (const auto done = bus_->transfer(address, ask, {}); !done) return done;
    std::array<std::uint8_t, 2> answer{};
    if (const auto done = fetch(control, answer); !done) return done;
    return join(answer[1], answer[0]) == identity ? base::Error::none : base::Error::no_answer;
  }

  base::Result<bq27500::Battery> read() {
    using namespace bq27500;
    std::array<std::uint8_t, 2> flag{}, power{}, charge{};
    std::array<std::uint8_t, 4> times{};
    if (const auto done = fetch(flags, flag); !done) return done.error;
    if (const auto done = fetch(time_to_empty, times); !done) return done.error;
    if (const auto done = fetch(average_power, power); !done) return done.error;
    if (const auto done = fetch(state_of_charge, charge); !done) return done.error;

    const std::uint16_t bits = join(flag[1], flag[0]);
    const std::uint16_t percent = join(charge[1], charge[0]);
    Battery battery;
    battery.present = (bits & battery_detected) != 0;
    battery.full = (bits & fully_charged) != 0;
    battery.minutes_to_empty = join(times[1], times[0]);
    battery.minutes_to_full = join(times[3], times[2]);
    battery.power_mw = join_signed(power[1], power[0]);
    battery.state_of_charge_percent = static_cast<std::uint8_t>(std::min<std::uint16_t>(percent, 100));
    return battery;
  }

  /// Its battery alone; zeros without one.
  base::Result<boards::BatteryReading> measure() {
    using namespace bq27500;
    std::array<std::uint8_t, 4> warmth{};
    std::array<std::uint8_t, 2> flag{}, charge{}, current{};
    if (const auto done = fetch(temperature, warmth); !done) return done.error;
    if (const auto done = fetch(flags, flag); !done) return done.error;
    if (const auto done = fetch(remaining_capacity, charge); !done) return done.error;
    if (const auto done = fetch(average_current, current); !done) return done.error;
    if ((join(flag[1], flag[0]) & battery_detected) == 0) return boards::BatteryReading{};
    return boards::BatteryReading{join(warmth[3], warmth[2]), join_signed(current[1], current[0]),
                                  join(charge[1], charge[0]), join(warmth[1], warmth[0])};
  }

 private:
  base::Status fetch(std::uint8_t command, std::span<std::uint8_t> bytes) {
    const std::array<std::uint8_t, 1> pointer{command};
    return bus_->transfer(bq27500::address, pointer, bytes);
  }

  Bus* bus_;
};

}  // namespace ocm::firmware::drivers
