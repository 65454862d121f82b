/// The parts of the mapper: what its application asks for (ocm/mapper/app/parts.hpp), by the real
/// drivers. Thesis 2's AVR robot: gyroscope LSM6DS3 on SPI, compass HMC5883L on I2C, four GP2Y0A21YK on a
/// converter, a servo, two motors with counters, two lamps, and the line to the dongle with its pin 19.
/// [Thesis 2, chapter 5 and its pinout of the ATmega1284] And a memory for the compass's calibration: the
/// thesis typed its offset into the program; here an EEPROM AT24C01B on the compass's bus, as on the AMiRo's
/// boards. [decided: docs/decisions/0029]
///
/// `ticks`, `gyro`, `field` and `infrared` are a transfer each, for tasks; `drive`, `turn_tower`, `show`,
/// `linked` and `send` do not wait and may be called anywhere; `store` and `stored` do not wait, and belong
/// to one task. Gyro, compass and memory are looked after by `maintain`: one that does not answer is tried
/// again each second, and says no_answer at once meanwhile. No heap.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/mapper/app/parts.hpp"
#include "ocm/motion/angle.hpp"
#include "ocm/motion/real.hpp"
#include "ocm/sensing/servo.hpp"

#include "firmware/boards/part_set.hpp"
#include "firmware/drivers/bus.hpp"
#include "firmware/drivers/compass_memory.hpp"
#include "firmware/drivers/gp2y0a21yk.hpp"
#include "firmware/drivers/hmc5883l.hpp"
#include "firmware/drivers/lsm6ds3.hpp"
#include "firmware/drivers/motor.hpp"
#include "firmware/drivers/part.hpp"

namespace ocm::firmware::boards::mapper {

/// Numbers of buses, devices, channels and pins, for code that names them.
namespace wiring {
inline constexpr std::uint8_t gyroscope_spi = 1;
inline constexpr std::uint8_t compass_i2c = 1;
/// Channels 0 to 3 of the converter: the sensors in the order of sensing::TowerSensor. [decided: the thesis's
/// two robots differ]
inline constexpr std::uint8_t first_infrared_channel = 0;
inline constexpr std::uint8_t servo_channel = 0;
inline constexpr std::uint8_t green_pin = 0x01;
inline constexpr std::uint8_t yellow_pin = 0x02;
}  // namespace wiring

/// Bits of `absent()`.
namespace part {
inline constexpr std::uint8_t gyroscope = 0x01;
inline constexpr std::uint8_t compass = 0x02;
inline constexpr std::uint8_t memory = 0x04;
}  // namespace part

/// The AVR's own converter, against its supply. [ATmega1284P data sheet 23.1: 10 bits]
inline constexpr drivers::ConverterScale converter_scale{10, 5.0F};
/// 1150 levels from 0 to 90 degrees [Thesis 2, 10.2.3]; a pulse of 1000 us at 0, a microsecond a level
/// [decided].
inline constexpr sensing::ServoCalibration servo_calibration{1000, 2150};
/// rad/s a digit of the gyroscope. [LSM6DS3 data sheet, table 3]
inline constexpr float rad_s_per_digit = 0.0175F * motion::pi / 180.0F;

/// The line to the dongle: `send` takes what has room, `linked` is its pin.
template <class D>
concept Dongle = requires(D& dongle, std::span<const std::uint8_t> bytes) {
  { dongle.send(bytes) } -> std::same_as<std::size_t>;
  { dongle.linked() } -> std::same_as<bool>;
};

/// The duty that an effort is, the nearest; 0 for what is no number.
[[nodiscard]] constexpr std::int16_t duty(float effort) noexcept {
  if (!motion::is_finite(effort)) return 0;
  const float counts = motion::clamp(effort, -1.0F, 1.0F) * float{drivers::full_duty};
  return static_cast<std::int16_t>(counts +
                                   (counts < 0.0F ? -0.5F : 0.5F));  // a motor's least effort moves it
}

template <drivers::I2c CompassBus, drivers::Spi GyroscopeDevice, drivers::Converter Infrared,
          drivers::MotorTimers Motors, drivers::PulseTimer Servo, drivers::Outputs Pins, Dongle Line,
          drivers::Mutex Lock = drivers::NoMutex>
class Parts
    : public PartSet<Parts<CompassBus, GyroscopeDevice, Infrared, Motors, Servo, Pins, Line, Lock>, 3> {
 public:
  /// All must outlive the parts.
  Parts(CompassBus& compass, GyroscopeDevice& gyroscope, Infrared& infrared, Motors& motors, Servo& servo,
        Pins& pins, Line& line)
      : gyroscope_(gyroscope),
        compass_(compass),
        memory_(compass),
        infrared_{Sensor{infrared, wiring::first_infrared_channel, converter_scale},
                  Sensor{infrared, wiring::first_infrared_channel + 1, converter_scale},
                  Sensor{infrared, wiring::first_infrared_channel + 2, converter_scale},
                  Sensor{infrared, wiring::first_infrared_channel + 3, converter_scale}},
        motors_(&motors),
        servo_(&servo),
        pins_(&pins),
        line_(&line) {}
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  /// Once, before anything else: motors off, lamps off, the tower ahead, each part tried.
  void start(base::Time now) {
    drive({});
    show({});
    turn_tower(sensing::servo_least_deg);
    this->start_parts(now);
  }
  /// To be called every 10 ms or so on a low level: looks after one part, or writes a piece of what is to be
  /// kept.
  void maintain(base::Time now) {
    if (memory_.running() && memory_.driver().busy()) return memory_.driver().step();
    this->maintain_one(now);
  }

  // --- what the application asks for ---

  [[nodiscard]] ocm::mapper::app::WheelTicks ticks() {
    const drivers::Guard<Lock> guard{lock_};  // two tasks ask
    const auto counters = motors_->encoders();
    for (std::size_t i = 0; i < 2; ++i) static_cast<void>(wheels_[i].sample(counters[i]));
    return {static_cast<std::uint32_t>(wheels_[0].total(counters[0])),
            static_cast<std::uint32_t>(wheels_[1].total(counters[1]))};
  }
  [[nodiscard]] base::Result<float> gyro() {
    const auto rate = gyroscope_.use([](auto& driver) { return driver.read(); });
    if (!rate) return rate.error;
    return static_cast<float>(rate->z) * rad_s_per_digit;  // z is up: left is positive
  }
  /// Gauss.
  [[nodiscard]] base::Result<sensing::Field> field() {
    const auto field = compass_.use([](auto& driver) { return driver.read(); });
    if (!field) return field.error;
    return sensing::Field{static_cast<float>(field->x) * 1e-6F, static_cast<float>(field->y) * 1e-6F};
  }
  [[nodiscard]] base::Result<float> infrared(std::size_t sensor) {
    if (sensor >= infrared_.size()) return base::Error::out_of_range;
    return infrared_[sensor].read();
  }
  void drive(motion::Efforts efforts) { motors_->set_duty(duty(efforts.left), duty(efforts.right)); }
  void turn_tower(std::int32_t degrees) {
    servo_->set_width(sensing::servo_count(degrees, servo_calibration));
  }
  void show(ocm::mapper::app::Lights lights) {
    pins_->write(static_cast<std::uint8_t>((lights.green ? wiring::green_pin : 0) |
                                           (lights.yellow ? wiring::yellow_pin : 0)));
  }
  [[nodiscard]] bool linked() { return line_->linked(); }
  [[nodiscard]] std::size_t send(std::span<const std::uint8_t> bytes) { return line_->send(bytes); }
  void store(const sensing::CompassFit& fit) { memory_.driver().store(fit); }
  [[nodiscard]] base::Result<sensing::CompassFit> stored() { return memory_.driver().stored(); }

  /// Bits of `part`.
  [[nodiscard]] std::uint8_t absent() const noexcept {
    return static_cast<std::uint8_t>(this->absent_bits());
  }

 private:
  using Sensor = drivers::Gp2y0a21yk<Infrared>;
  friend class PartSet<Parts, 3>;
  template <class Self, class F>
  static void pick(Self& self, std::size_t number, F what) {
    if (number == 0)
      what(self.gyroscope_);
    else if (number == 1)
      what(self.compass_);
    else
      what(self.memory_);
  }

  drivers::Part<drivers::Lsm6ds3<GyroscopeDevice>> gyroscope_;
  drivers::Part<drivers::Hmc5883l<CompassBus>> compass_;
  drivers::Part<drivers::CompassMemory<CompassBus>> memory_;
  std::array<Sensor, 4> infrared_;
  std::array<drivers::WheelCounter, 2> wheels_;
  Motors* motors_;
  Servo* servo_;
  Pins* pins_;
  Line* line_;
  Lock lock_{};
};

}  // namespace ocm::firmware::boards::mapper
