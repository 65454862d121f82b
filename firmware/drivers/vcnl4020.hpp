/// Proximity sensor VCNL4020 on I2C: 250 measurements/s at 200 mA.
///
/// 5 bytes on the bus a sample: 0.13 ms at 400 kbit/s, 0.5 ms at 100. Errors: no_answer, not acknowledged,
/// not this part or not as configured; bus_fault. [data sheet: Vishay VCNL4020, document 83476]
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <span>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"

#include "firmware/drivers/bus.hpp"
#include "firmware/drivers/bytes.hpp"

namespace ocm::firmware::drivers {

namespace vcnl4020 {

inline constexpr std::uint8_t address = 0x13;  ///< [data sheet, Device Address]

// Registers. [data sheet, Register Functions]
inline constexpr std::uint8_t command = 0x80;
inline constexpr std::uint8_t product_id = 0x81;
inline constexpr std::uint8_t proximity_rate = 0x82;
inline constexpr std::uint8_t led_current = 0x83;
inline constexpr std::uint8_t proximity_result = 0x87;  ///< high byte, then low byte

inline constexpr std::uint8_t identity = 0x21;  ///< product 2, revision 1 [table 2]

inline constexpr std::uint8_t standby = 0x00;          ///< the rate can be changed only now [table 1, note]
inline constexpr std::uint8_t self_timed = 0x03;       ///< selftimed_en, prox_en [table 1]
inline constexpr std::uint8_t self_timed_mask = 0x1F;  ///< without config_lock and the two ready bits
inline constexpr std::uint8_t rate_250_hz = 0x07;      ///< [table 3; AMiRo-OS: 125 Hz]
inline constexpr std::uint8_t led_200_ma = 20;         ///< in 10 mA [table 4; AMiRo-OS: 200 mA]
inline constexpr std::uint8_t led_mask = 0x3F;

/// A measurement period, and some for the oscillator.
inline constexpr base::Duration turn_on = std::chrono::milliseconds{5};

}  // namespace vcnl4020

template <I2c Bus>
class Vcnl4020 {
 public:
  /// A bus by value, such as the channel of a multiplexer.
  explicit Vcnl4020(Bus bus) noexcept : bus_(bus) {}

  base::Result<base::Duration> start() {
    using namespace vcnl4020;
    std::array<std::uint8_t, 1> who{};
    if (const auto done = fetch(product_id, who); !done) return done.error;
    if (who[0] != identity) return base::Error::no_answer;
    if (const auto done = write(command, standby); !done) return done.error;
    if (const auto done = write(proximity_rate, rate_250_hz); !done) return done.error;
    if (const auto done = write(led_current, led_200_ma); !done) return done.error;
    if (const auto done = write(command, self_timed); !done) return done.error;
    return turn_on;
  }

  base::Status check() {
    using namespace vcnl4020;
    std::array<std::uint8_t, 4> registers{};
    if (const auto done = fetch(command, registers); !done) return done.error;
    const bool ours = (registers[0] & self_timed_mask) == self_timed && registers[1] == identity &&
                      registers[2] == rate_250_hz && (registers[3] & led_mask) == led_200_ma;
    return ours ? base::Error::none : base::Error::no_answer;
  }

  /// Counts, offset included; larger is nearer.
  base::Result<std::uint16_t> read() {
    std::array<std::uint8_t, 2> counts{};
    if (const auto done = fetch(vcnl4020::proximity_result, counts); !done) return done.error;
    return join(counts[0], counts[1]);
  }

 private:
  base::Status fetch(std::uint8_t first, std::span<std::uint8_t> registers) {
    const std::array<std::uint8_t, 1> pointer{first};
    return bus_.transfer(vcnl4020::address, pointer, registers);
  }
  base::Status write(std::uint8_t where, std::uint8_t what) {
    const std::array<std::uint8_t, 2> bytes{where, what};
    return bus_.transfer(vcnl4020::address, bytes, {});
  }

  Bus bus_;
};

}  // namespace ocm::firmware::drivers
