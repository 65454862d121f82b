/// Gyroscope, accelerometer and magnetometer: what the robot does, as these parts report it. Pure functions
/// of the motion and of the number of the sample.
#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>

#include "ocm/base/time.hpp"

#include "firmware/boards/samples.hpp"
#include "sim/amiro/arena.hpp"
#include "sim/amiro/drive.hpp"
#include "sim/physics/digits.hpp"
#include "sim/physics/noise.hpp"

namespace ocm::sim {

/// One sample: what there is to measure, which number it has, and the noise of its part.
struct Sample {
  Motion motion{};
  std::uint64_t number = 0;
  Noise noise;
  bool noisy = true;

  [[nodiscard]] constexpr double normal(std::uint8_t channel) const noexcept {
    return noisy ? noise.normal(number, channel) : 0.0;
  }
  /// Drawn once for the part: bias, offset.
  [[nodiscard]] constexpr double constant(std::uint8_t channel) const noexcept {
    return noise.constant(channel);
  }
};

/// L3G4200D at +-500 deg/s, 800 samples/s, low-pass at 30 Hz. [data sheet]
struct GyroscopeModel {
  base::Duration period = std::chrono::microseconds{1250};
  double deg_per_s_per_digit = 0.0175;
  double range_deg_per_s = 500;
  /// 0.03 deg/s/sqrt(Hz) over 30 Hz. The thesis's log agrees: neighbouring samples differ by about 9 digits.
  double noise_deg_per_s = 0.164;
  /// Spread of the bias from part to part. The thesis's log shows 1.1, 0.5 and -0.1 deg/s at rest. [decided]
  double bias_deg_per_s = 0.5;

  [[nodiscard]] firmware::boards::AngularRate read(const Sample& sample) const noexcept {
    return {axis(0, sample, 0), axis(0, sample, 1), axis(sample.motion.turn_rad_per_s / degree, sample, 2)};
  }
  /// The bias of this world's part, deg/s, axis 0..2.
  [[nodiscard]] double bias(const Sample& sample, std::uint8_t channel) const noexcept {
    return bias_deg_per_s * sample.constant(channel);
  }

 private:
  [[nodiscard]] std::int16_t axis(double deg_per_s, const Sample& sample,
                                  std::uint8_t channel) const noexcept {
    const double measured = deg_per_s + bias(sample, channel) + noise_deg_per_s * sample.normal(channel);
    const double most = std::floor(range_deg_per_s / deg_per_s_per_digit);
    return digits<std::int16_t>(measured / deg_per_s_per_digit, -most, most);
  }
};

/// LIS331DLH at +-4 g, 1000 samples/s, low-pass at 780 Hz. [data sheet; range: AMiRo-OS, FS_4G]
struct AccelerometerModel {
  base::Duration period = std::chrono::milliseconds{1};
  double range_g = 4;
  double digits_per_g = 512;  ///< 12 bits over the range, [-2048, 2047]
  double noise_g = 0.0061;    ///< 218 ug/sqrt(Hz) over 780 Hz
  double offset_g = 0.020;    ///< typical zero-g offset; the thesis's log shows 26 digits on x

  static constexpr double standard_gravity_m_per_s2 = 9.80665;

  /// In the middle between the wheels. [decided]
  [[nodiscard]] firmware::boards::SpecificForce read(const Sample& sample) const noexcept {
    const Vector a = sample.motion.acceleration_m_per_s2 * (1 / standard_gravity_m_per_s2);
    return {axis(a.x, sample, 0), axis(a.y, sample, 1), axis(1, sample, 2)};
  }

 private:
  [[nodiscard]] std::int16_t axis(double g, const Sample& sample, std::uint8_t channel) const noexcept {
    const double measured = g + offset_g * sample.constant(channel) + noise_g * sample.normal(channel);
    const double end = range_g * digits_per_g;
    const auto digit = digits<std::int16_t>(measured * digits_per_g, -end, end - 1);
    return static_cast<std::int16_t>(digit * (1024 / digits_per_g));  // in 1/1024 g, as it travels: even
  }
};

/// HMC5883L at +-4.7 G, 75 samples/s. [data sheet]
struct MagnetometerModel {
  base::Duration period = std::chrono::microseconds{13334};
  std::int32_t microgauss_per_count = 2560;
  std::int32_t lowest_count = -2048;  ///< of the 12-bit converter
  std::int32_t highest_count = 2047;
  double noise_gauss = 0.002;
  /// The motors' magnets. In the default world's start pose the part then reads what the thesis's log shows:
  /// 0.05376, -0.93952, 1.5232 G.
  firmware::boards::Axes<double> hard_iron_gauss{0.05376, -1.13952, 1.9732};

  [[nodiscard]] firmware::boards::MagneticField read(const Arena& arena,
                                                     const Sample& sample) const noexcept {
    const Vector horizontal =
        direction(arena.north_rad - sample.motion.pose.heading_rad) * arena.field_horizontal_gauss;
    return {axis(horizontal.x + hard_iron_gauss.x, sample, 0),
            axis(horizontal.y + hard_iron_gauss.y, sample, 1),
            axis(hard_iron_gauss.z - arena.field_down_gauss, sample, 2)};
  }

 private:
  [[nodiscard]] std::int32_t axis(double gauss, const Sample& sample, std::uint8_t channel) const noexcept {
    const double measured = gauss + noise_gauss * sample.normal(channel);
    return microgauss_per_count *
           digits<std::int32_t>(measured * 1e6 / microgauss_per_count, lowest_count, highest_count);
  }
};

}  // namespace ocm::sim
