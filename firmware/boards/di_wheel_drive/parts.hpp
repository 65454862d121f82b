/// The parts of DiWheelDrive on its buses: what its Board asks for, by the real drivers. Which pins and
/// addresses, and from where that is known: docs/parts.md.
///
/// Who may call what: each sensor one level at a time; `set_wheels` and `control` one context; `maintain` one
/// low level; `encoders`, `calibrate_floor` and what is said for the status frames any. Buses that several
/// of these share lock inside, and `Lock` (with priority inheritance where levels preempt) guards the
/// multiplexer.
///
/// No heap, no waiting: a part that is away answers Error::no_answer at once, and `maintain` looks for it. A
/// floor sample is 8 transfers, 1 ms at 400 kbit/s; all others are one.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"

#include "firmware/boards/di_wheel_drive/board.hpp"
#include "firmware/boards/di_wheel_drive/geometry.hpp"
#include "firmware/boards/part_set.hpp"
#include "firmware/boards/samples.hpp"
#include "firmware/drivers/bus.hpp"
#include "firmware/drivers/calibration.hpp"
#include "firmware/drivers/hmc5883l.hpp"
#include "firmware/drivers/l3g4200d.hpp"
#include "firmware/drivers/lis331dlh.hpp"
#include "firmware/drivers/motor.hpp"
#include "firmware/drivers/part.hpp"
#include "firmware/drivers/pca9544.hpp"
#include "firmware/drivers/vcnl4020.hpp"
#include "firmware/drivers/wheel_controller.hpp"

namespace ocm::firmware::boards::di_wheel_drive {

/// Numbers of buses and devices, for code that names them. [AMiRo-OS 1.0, DiWheelDrive: global.hpp]
namespace wiring {
inline constexpr std::uint8_t compass_i2c = 1;         ///< I2C1, 400 kbit/s
inline constexpr std::uint8_t floor_i2c = 2;           ///< I2C2, 400 kbit/s: multiplexer and EEPROM
inline constexpr std::uint8_t gyroscope_spi = 1;       ///< SPI1, chip select PC14
inline constexpr std::uint8_t accelerometer_spi = 2;   ///< SPI1, chip select PC13
inline constexpr std::uint8_t motor_power_pin = 0x01;  ///< output bit 0: PB2, POWER_EN
}  // namespace wiring

/// Bits of `absent()`.
namespace part {
inline constexpr std::uint8_t gyroscope = 0x01;
inline constexpr std::uint8_t accelerometer = 0x02;
inline constexpr std::uint8_t magnetometer = 0x04;
inline constexpr std::uint8_t floor_1 = 0x08;  ///< and the next three bits: sensors 2 to 4
inline constexpr std::uint8_t eeprom = 0x80;
}  // namespace part

/// A wheel's speed at full duty, in the controller's unit. The motor's own is not published; the integral
/// makes up for the difference. [decided]
inline constexpr std::int32_t full_speed =
    static_cast<std::int32_t>(greatest_wheel_speed_m_per_s / metres_per_tick *
                                  std::chrono::duration<double>(control_period).count() * 256 +
                              0.5);
static_assert(full_speed == 20595);  // 80 ticks in 10 ms

template <drivers::I2c CompassBus, drivers::I2c FloorBus, drivers::Spi GyroscopeDevice,
          drivers::Spi AccelerometerDevice, drivers::MotorTimers Motors, drivers::Outputs Pins,
          drivers::Mutex Lock = drivers::NoMutex>
class Parts
    : public PartSet<Parts<CompassBus, FloorBus, GyroscopeDevice, AccelerometerDevice, Motors, Pins, Lock>,
                     8> {
  friend PartSet<Parts, 8>;

 public:
  static constexpr std::size_t floor_sensors = 4;

  /// All must outlive the parts.
  Parts(CompassBus& compass, FloorBus& floor, GyroscopeDevice& gyroscope, AccelerometerDevice& accelerometer,
        Motors& motors, Pins& pins)
      : motors_(&motors),
        pins_(&pins),
        multiplexer_(floor),
        gyroscope_(gyroscope),
        accelerometer_(accelerometer),
        magnetometer_(compass),
        calibration_(floor) {}
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  /// Once, before anything else: motors without voltage but with power, each part tried once.
  void start(base::Time now) {
    motors_->set_duty(0, 0);
    pins_->write(wiring::motor_power_pin);
    this->start_parts(now);
  }

  /// To be called every 10 ms or so on a low level: looks after one part, or takes one step of a calibration.
  void maintain(base::Time now) {
    if (calibration_.driver().busy())
      return calibration_.driver().step([this](std::size_t sensor) { return raw_floor(sensor); });
    this->maintain_one(now);
  }

  // --- what the board asks for ---

  base::Result<AngularRate> gyroscope() {
    return gyroscope_.use([](auto& part) { return part.read(); });
  }
  base::Result<SpecificForce> accelerometer() {
    return accelerometer_.use([](auto& part) { return part.read(); });
  }
  base::Result<MagneticField> magnetometer() {
    return magnetometer_.use([](auto& part) { return part.read(); });
  }
  /// Less the offset, and not below 0. An error when one of the four has none.
  base::Result<FloorCounts> floor() {
    FloorCounts counts{};
    for (std::size_t i = 0; i < floor_sensors; ++i) {
      const auto raw = raw_floor(i);
      if (!raw) return raw.error;
      const std::uint16_t offset = calibration_.driver().offset(i);
      counts[i] = static_cast<std::uint16_t>(*raw > offset ? *raw - offset : 0);
    }
    return counts;
  }
  base::Result<WheelTicks> encoders() {
    const std::array<std::uint16_t, 2> counters = motors_->encoders();
    return WheelTicks{wheels_[0].counter.total(counters[0]), wheels_[1].counter.total(counters[1])};
  }
  void set_wheels(WheelSpeeds speeds) noexcept {
    wheels_[0].speed = steps(speeds.left);
    wheels_[1].speed = steps(speeds.right);
  }

  /// One step of the two speed controllers, every `control_period`.
  void control() {
    const std::array<std::uint16_t, 2> counters = motors_->encoders();
    std::array<std::int16_t, 2> duty{};
    for (std::size_t i = 0; i < 2; ++i) {
      Wheel& wheel = wheels_[i];
      duty[i] = wheel.controller.step(wheel.speed, wheel.counter.sample(counters[i]));
    }
    motors_->set_duty(duty[0], duty[1]);
  }

  /// Takes what the floor sensors see now for their offset and keeps it in the EEPROM, or forgets it. The
  /// robot is held up meanwhile: nothing to be seen. It takes 16 samples of each sensor, 64 calls of
  /// `maintain`. Error::full while one is under way. [AMiRo-OS 1.0: shell command of DiWheelDrive]
  base::Status calibrate_floor(bool forget) noexcept { return calibration_.driver().request(forget); }
  [[nodiscard]] bool calibrating() const noexcept { return calibration_.driver().busy(); }
  /// How the last calibration ended.
  [[nodiscard]] base::Error calibration_error() const noexcept { return calibration_.driver().last(); }

  // --- for the status frames ---

  /// Bit by bit who does not answer; the same numbers have the faults of `PartSet`.
  [[nodiscard]] std::uint8_t absent() const noexcept {
    return static_cast<std::uint8_t>(this->absent_bits());
  }

 private:
  using Multiplexer = drivers::Pca9544<FloorBus, Lock>;
  using FloorSensor = drivers::Part<drivers::Vcnl4020<typename Multiplexer::Channel>>;

  struct Wheel {
    drivers::WheelCounter counter;
    drivers::WheelController controller{drivers::WheelGains::for_full_speed(full_speed)};
    std::int16_t speed = 0;  // 1/256 tick a control_period
  };

  /// A wheel's speed in the controller's unit.
  [[nodiscard]] static std::int16_t steps(double m_per_s) noexcept {
    const double speed = m_per_s * (full_speed / greatest_wheel_speed_m_per_s);
    const double bounded = speed > full_speed ? full_speed : speed < -full_speed ? -full_speed : speed;
    return static_cast<std::int16_t>(bounded + (bounded < 0 ? -0.5 : 0.5));
  }

  base::Result<std::uint16_t> raw_floor(std::size_t sensor) {
    return floor_[sensor].use([](auto& part) { return part.read(); });
  }

  /// The parts by their number in `absent()`.
  template <class Self, class F>
  static void pick(Self& self, std::size_t number, F what) {
    switch (number) {
      case 0:
        return what(self.gyroscope_);
      case 1:
        return what(self.accelerometer_);
      case 2:
        return what(self.magnetometer_);
      case 7:
        return what(self.calibration_);
      default:
        if (number < Parts::parts) what(self.floor_[number - 3]);
    }
  }
  Motors* motors_;
  Pins* pins_;
  Multiplexer multiplexer_;
  drivers::Part<drivers::L3g4200d<GyroscopeDevice>> gyroscope_;
  drivers::Part<drivers::Lis331dlh<AccelerometerDevice>> accelerometer_;
  drivers::Part<drivers::Hmc5883l<CompassBus>> magnetometer_;
  // Sensor i + 1 is on channel i. [AMiRo-OS 1.0, global.hpp; what they look at: spec/conflicts.md]
  std::array<FloorSensor, floor_sensors> floor_{
      FloorSensor{multiplexer_.channel(0)}, FloorSensor{multiplexer_.channel(1)},
      FloorSensor{multiplexer_.channel(2)}, FloorSensor{multiplexer_.channel(3)}};
  drivers::Part<drivers::Calibration<FloorBus, floor_sensors>> calibration_;
  std::array<Wheel, 2> wheels_{};
};

}  // namespace ocm::firmware::boards::di_wheel_drive
