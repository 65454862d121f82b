/// The parts of the mapper as models of their registers, on whatever gives the robot's parts in their own
/// units: a robot of a world, or a test's script. The other way round from boards/mapper/parts.hpp: what
/// that makes of registers, this makes registers of.
///
/// Host only, one thread. The world's owner lets its time pass.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "ocm/base/result.hpp"
#include "ocm/mapper/app/parts.hpp"
#include "ocm/sensing/servo.hpp"
#include "ocm/sensing/tower.hpp"

#include "firmware/boards/mapper/parts.hpp"
#include "firmware/drivers/bus.hpp"
#include "firmware/qemu/parts_frames.hpp"
#include "sim/parts/at24c01b_model.hpp"
#include "sim/parts/hmc5883l_model.hpp"
#include "sim/parts/i2c_bus.hpp"
#include "sim/parts/lsm6ds3_model.hpp"
#include "sim/parts/part_clock.hpp"
#include "sim/parts/spi_device.hpp"
#include "sim/parts/transfers.hpp"
#include "sim/parts/violations.hpp"

namespace ocm::sim {

/// Degrees of a pulse: what sensing::servo_count() turns into counts.
[[nodiscard]] inline std::int32_t servo_degrees(std::uint16_t counts) {
  const auto& servo = firmware::boards::mapper::servo_calibration;
  const double span = servo.count_at_90_deg - servo.count_at_0_deg;
  return static_cast<std::int32_t>(
      std::lround((counts - servo.count_at_0_deg) * double{sensing::servo_most_deg} / span));
}

/// Counts of the converter; beyond its ends the nearest.
[[nodiscard]] inline std::uint16_t converter_counts(double volts) {
  const auto& scale = firmware::boards::mapper::converter_scale;
  const double most = (1 << scale.bits) - 1;
  return static_cast<std::uint16_t>(std::clamp(std::round(volts / scale.reference_v * most), 0.0, most));
}

/// Numbers of buses, devices, channels and pins: boards/mapper/parts.hpp, wiring.
template <ocm::mapper::app::RobotParts P>
class RobotModels {
 public:
  /// `parts` must outlive the models.
  RobotModels(P& parts, const PartClock& now)
      : parts_(&parts),
        gyroscope(violations_, now,
                  [&parts] {
                    return Lsm6ds3Model::Rates{0, 0, *parts.gyro()};
                  }),
        compass(violations_, now, [&parts] { return microgauss(*parts.field()); }),
        memory(violations_, now) {
    gyroscope.set_presence([&parts] { return parts.gyro().ok(); });
    compass.set_presence([&parts] { return parts.field().ok(); });
    bus_.attach(compass);
    bus_.attach(memory);
  }

  /// What the board asks its host. Error::bad_mode: no such question; bad_length: not with so many bytes.
  [[nodiscard]] base::Status answer(const firmware::qemu::link::Request& request,
                                    std::span<std::uint8_t> read) {
    using firmware::qemu::link::Kind;
    namespace wiring = firmware::boards::mapper::wiring;
    const auto in = request.written;
    switch (request.kind) {
      case Kind::i2c:
        return transfer(request.unit == wiring::compass_i2c ? bus_ : no_bus_, request, read);
      case Kind::spi:
        if (request.unit == wiring::gyroscope_spi) return transfer(gyroscope, request, read);
        return transfer(no_device_, request, read);
      case Kind::set_duty:
        if (in.size() != 4) return base::Error::bad_length;
        parts_->drive({effort(word_at(in, 0)), effort(word_at(in, 2))});
        return {};
      case Kind::encoders: {
        const ocm::mapper::app::WheelTicks ticks = parts_->ticks();
        return put(read, std::array{static_cast<std::uint16_t>(ticks.left),
                                    static_cast<std::uint16_t>(ticks.right)});
      }
      case Kind::outputs:
        if (in.size() != 1) return base::Error::bad_length;
        parts_->show({(in[0] & wiring::green_pin) != 0, (in[0] & wiring::yellow_pin) != 0});
        return {};
      case Kind::convert: {
        if (request.unit >= wiring::first_infrared_channel + sensing::tower_sensors)
          return base::Error::bad_mode;
        const auto volts = parts_->infrared(request.unit - std::size_t{wiring::first_infrared_channel});
        if (!volts) return volts.error;
        return put(read, std::array{converter_counts(*volts)});
      }
      case Kind::set_pulse:
        if (in.size() != 2) return base::Error::bad_length;
        if (request.unit != wiring::servo_channel) return base::Error::bad_mode;
        parts_->turn_tower(servo_degrees(word_at(in, 0)));
        return {};
      case Kind::inputs:
        break;
    }
    return base::Error::bad_mode;
  }

  /// What drivers did that data sheets forbid.
  [[nodiscard]] Violations& violations() noexcept { return violations_; }

 private:
  P* parts_;
  Violations violations_;

 public:
  Lsm6ds3Model gyroscope;
  Hmc5883lModel compass;
  At24c01bModel memory;

 private:
  [[nodiscard]] static firmware::boards::MagneticField microgauss(sensing::Field gauss) {
    const auto of = [](float axis) { return static_cast<std::int32_t>(std::lround(axis * 1e6)); };
    return {of(gauss.x), of(gauss.y), 0};
  }
  [[nodiscard]] static float effort(std::uint16_t duty) {
    return static_cast<float>(static_cast<std::int16_t>(duty)) / float{firmware::drivers::full_duty};
  }
  template <std::size_t N>
  [[nodiscard]] static base::Status put(std::span<std::uint8_t> read,
                                        const std::array<std::uint16_t, N>& words) {
    if (read.size() != 2 * N) return base::Error::bad_length;
    for (std::size_t i = 0; i < read.size(); ++i)
      read[i] = static_cast<std::uint8_t>(words[i / 2] >> (i % 2 * 8));
    return {};
  }

  I2cBus bus_{violations_};
  I2cBus no_bus_{violations_};
  NoSpiDevice no_device_;
};

}  // namespace ocm::sim
