/// Sensor of proximity and ambient light VCNL4020 on I2C: 250 measurements/s of proximity at 200 mA and,
/// where it is asked for, 10 of ambient light.
///
/// Ambient light is one conversion, not the mean of 32 with which the part begins: a measurement of proximity
/// may have to wait for one of light, which is as short as can be so. Lamps flicker in it.
///
/// 5 bytes on the bus a sample: 0.13 ms at 400 kbit/s, 0.5 ms at 100. Errors: no_answer, not acknowledged,
/// not this part or not as configured; bus_fault. [data sheet: Vishay VCNL4020, document 83476]
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <span>
#include <type_traits>

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
inline constexpr std::uint8_t ambient_parameter = 0x84;
inline constexpr std::uint8_t ambient_result = 0x85;    ///< high byte, then low byte
inline constexpr std::uint8_t proximity_result = 0x87;  ///< high byte, then low byte

inline constexpr std::uint8_t identity = 0x21;  ///< product 2, revision 1 [table 2]

inline constexpr std::uint8_t standby = 0x00;          ///< the rate can be changed only now [table 1, note]
inline constexpr std::uint8_t self_timed = 0x03;       ///< selftimed_en, prox_en [table 1]
inline constexpr std::uint8_t ambient_enabled = 0x04;  ///< als_en [table 1]
inline constexpr std::uint8_t ambient_ready = 0x40;    ///< als_data_rdy, until the result is read [table 1]
inline constexpr std::uint8_t self_timed_mask = 0x1F;  ///< without config_lock and the two ready bits
inline constexpr std::uint8_t rate_250_hz = 0x07;      ///< [table 3; AMiRo-OS: 125 Hz]
inline constexpr std::uint8_t led_200_ma = 20;         ///< in 10 mA [table 4; AMiRo-OS: 200 mA]
inline constexpr std::uint8_t led_mask = 0x3F;
/// als_rate 10 samples/s, auto offset compensation, one conversion. [table 5]
inline constexpr std::uint8_t ambient_10_hz = 0x78;

/// A measurement period, and some for the oscillator.
inline constexpr base::Duration turn_on = std::chrono::milliseconds{5};

}  // namespace vcnl4020

/// `with_light`: it measures ambient light, too.
template <I2c Bus, bool with_light = false>
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
    if constexpr (with_light) {
      if (const auto done = write(ambient_parameter, ambient_10_hz); !done) return done.error;
      std::array<std::uint8_t, 2> old{};  // a result from before is no longer ready once it was read
      if (const auto done = fetch(ambient_result, old); !done) return done.error;
      lit_ = false;
    }
    if (const auto done = write(command, measuring); !done) return done.error;
    return turn_on;
  }

  base::Status check() {
    using namespace vcnl4020;
    std::array<std::uint8_t, with_light ? 5 : 4> registers{};
    if (const auto done = fetch(command, registers); !done) return done.error;
    const bool ours = (registers[0] & self_timed_mask) == measuring && registers[1] == identity &&
                      registers[2] == rate_250_hz && (registers[3] & led_mask) == led_200_ma &&
                      (!with_light || registers.back() == ambient_10_hz);
    return ours ? base::Error::none : base::Error::no_answer;
  }

  /// Counts, offset included; larger is nearer.
  base::Result<std::uint16_t> read() {
    std::array<std::uint8_t, 2> counts{};
    if (const auto done = fetch(vcnl4020::proximity_result, counts); !done) return done.error;
    return join(counts[0], counts[1]);
  }

  /// Ambient light, 0.25 lx a count. Error::not_sampled before the first measurement, of which it asks with
  /// one more transfer.
  base::Result<std::uint16_t> light() requires with_light {
    if (!lit_) {
      std::array<std::uint8_t, 1> status{};
      if (const auto done = fetch(vcnl4020::command, status); !done) return done.error;
      if ((status[0] & vcnl4020::ambient_ready) == 0) return base::Error::not_sampled;
      lit_ = true;
    }
    std::array<std::uint8_t, 2> counts{};
    if (const auto done = fetch(vcnl4020::ambient_result, counts); !done) return done.error;
    return join(counts[0], counts[1]);
  }

 private:
  static constexpr std::uint8_t measuring =
      vcnl4020::self_timed | (with_light ? vcnl4020::ambient_enabled : std::uint8_t{0});

  base::Status fetch(std::uint8_t first, std::span<std::uint8_t> registers) {
    const std::array<std::uint8_t, 1> pointer{first};
    return bus_.transfer(vcnl4020::address, pointer, registers);
  }
  base::Status write(std::uint8_t where, std::uint8_t what) {
    const std::array<std::uint8_t, 2> bytes{where, what};
    return bus_.transfer(vcnl4020::address, bytes, {});
  }

  Bus bus_;
  struct Nothing {};
  // Ambient light was measured since the start. Two levels look at it.
  [[no_unique_address]] std::conditional_t<with_light, std::atomic<bool>, Nothing> lit_{};
};

}  // namespace ocm::firmware::drivers
