/// What the parts of the boards deliver, in their own units: the least that a driver and a board agree on.
/// Plain data, no heap.
#pragma once

#include <array>
#include <cstdint>

namespace ocm::firmware::boards {

/// One sample of a part with three axes: x forwards, y to the left, z up.
template <class T>
struct Axes {
  T x{};
  T y{};
  T z{};
  friend constexpr bool operator==(const Axes&, const Axes&) = default;
};

/// Angular velocity, 0.0175 deg/s a digit. [L3G4200D data sheet, table 4, at 500 deg/s]
using AngularRate = Axes<std::int16_t>;
/// Specific force, 1/1024 g a digit; z reads +1 g at rest.
using SpecificForce = Axes<std::int16_t>;
/// Magnetic field, uG, in steps of 2560. [HMC5883L data sheet: 390 counts/G at +-4.7 G]
using MagneticField = Axes<std::int32_t>;

using FloorCounts = std::array<std::uint16_t, 4>;  ///< sensors 1..4, offset removed
using RingCounts = std::array<std::uint16_t, 8>;   ///< sensors 1..8, offset included

/// The encoders' running totals, forwards positive. They wrap around.
struct WheelTicks {
  std::int32_t left = 0;
  std::int32_t right = 0;
  friend constexpr bool operator==(const WheelTicks&, const WheelTicks&) = default;
};

/// Velocity of each wheel's contact point, m/s, forwards positive.
struct WheelSpeeds {
  double left = 0;
  double right = 0;
  friend constexpr bool operator==(const WheelSpeeds&, const WheelSpeeds&) = default;
};

/// What the fuel gauge says. [BQ27500 data sheet]
struct GaugeReading {
  bool plugged = false;
  bool charging = false;
  std::uint8_t state_of_charge_percent = 0;  ///< 0..100
  std::uint16_t minutes = 65535;             ///< to full when charging, else to empty; 65535: unknown
  std::int16_t power_mw = 0;                 ///< negative: out of the batteries
  friend constexpr bool operator==(const GaugeReading&, const GaugeReading&) = default;
};

/// What one battery's gauge measures; all zeros without a battery. [BQ27500 data sheet, table 4-1]
struct BatteryReading {
  std::uint16_t voltage_mv = 0;
  std::int16_t current_ma = 0;  ///< mean of a second, negative: out of the battery
  std::uint16_t remaining_mah = 0;
  std::uint16_t temperature_dk = 0;  ///< 0.1 K
  friend constexpr bool operator==(const BatteryReading&, const BatteryReading&) = default;
};
using BatteryReadings = std::array<BatteryReading, 2>;  ///< of P7, the front one, and P8

using RingLight = std::array<std::uint16_t, 8>;  ///< ambient light of sensors 1..8, 0.25 lx

struct Colour {
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;
  friend constexpr bool operator==(const Colour&, const Colour&) = default;
};

}  // namespace ocm::firmware::boards
