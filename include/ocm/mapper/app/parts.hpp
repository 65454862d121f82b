/// What the mapper's application asks of a robot's hardware: wheels, gyro, compass, distance sensors,
/// tower, lights, a memory that needs no power, and the serial line to its radio. A world, registers of real
/// parts and a test's script all have it.
///
/// Nothing here may wait: a part that is slow delivers its last sample. A part that does not answer says so
/// in its result, and the application counts it and goes on without. No heap.
///
/// | who calls | what |
/// |---|---|
/// | any context, interrupts too, with the port's lock held | drive, linked |
/// | two tasks, of which one may preempt the other | ticks |
/// | one task at a time | gyro, field, infrared, turn_tower, show, send, store, stored |
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/base/result.hpp"
#include "ocm/motion/limits.hpp"
#include "ocm/sensing/compass_calibration.hpp"

namespace ocm::mapper::app {

/// Running counters of both wheels; they wrap, up forwards, down backwards.
struct WheelTicks {
  std::uint32_t left = 0;
  std::uint32_t right = 0;
  friend constexpr bool operator==(const WheelTicks&, const WheelTicks&) = default;
};

/// The robot's two lamps. [T2 §6.3]
struct Lights {
  bool green = false;
  bool yellow = false;
  friend constexpr bool operator==(const Lights&, const Lights&) = default;
};

/// - `ticks()`: where both wheels are
/// - `gyro()`: rad/s, left is positive; with its bias
/// - `field()`: gauss, horizontally in the robot's frame, x ahead, y to the left; with the robot's own
///   magnetism
/// - `infrared(sensor)`: volts of sensor 0 to 3, in the order of sensing::TowerSensor
/// - `drive(efforts)`: each motor, [-1, 1]; 0 is off. Pulse widths are the part's affair
/// - `turn_tower(degrees)`: [0, 90]; the servo needs time to get there
/// - `show(lights)`
/// - `linked()`: the dongle's pin 19: there is a connection [T2 §6.4.1]
/// - `send(bytes)`: to the dongle's UART; how many of them found room. The caller counts the rest
/// - `store(fit)`: begins to keep the compass's calibration for when the robot is switched on again
/// - `stored()`: what is kept, once it is; Error::not_sampled: nothing, or it is being written
template <class P>
concept RobotParts = requires(P& parts, motion::Efforts efforts, std::size_t sensor, std::int32_t degrees,
                              Lights lights, std::span<const std::uint8_t> bytes,
                              const sensing::CompassFit& fit) {
  { parts.ticks() } -> std::same_as<WheelTicks>;
  { parts.gyro() } -> std::same_as<base::Result<float>>;
  { parts.field() } -> std::same_as<base::Result<sensing::Field>>;
  { parts.infrared(sensor) } -> std::same_as<base::Result<float>>;
  parts.drive(efforts);
  parts.turn_tower(degrees);
  parts.show(lights);
  { parts.linked() } -> std::same_as<bool>;
  { parts.send(bytes) } -> std::same_as<std::size_t>;
  parts.store(fit);
  { parts.stored() } -> std::same_as<base::Result<sensing::CompassFit>>;
};

}  // namespace ocm::mapper::app
