/// What gyro, compass and distance sensors of a mapper report: pure functions of what there is to
/// measure, of the number of the sample and of the part's noise. Reading advances nothing. About 20 ns a
/// value.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "ocm/sensing/compass_calibration.hpp"
#include "ocm/sensing/ir_sensor.hpp"
#include "ocm/sensing/tower.hpp"

#include "sim/mapper/robot_model.hpp"
#include "sim/physics/digits.hpp"
#include "sim/physics/geometry.hpp"
#include "sim/physics/noise.hpp"

namespace ocm::sim::mapper {

/// Noise that changes slowly: a number a place, straight lines between them. `steps` counts places.
[[nodiscard]] inline double slow_noise(const Noise& noise, double steps, std::uint8_t channel) noexcept {
  const double whole = std::floor(steps);
  const auto place = static_cast<std::uint64_t>(whole);
  const double before = noise.normal(place, channel);
  return before + (noise.normal(place + 1, channel) - before) * (steps - whole);
}

// Gyro

struct GyroSample {
  std::uint64_t number = 0;
  double turn_rad_per_s = 0;
  bool driving = false;  ///< a motor is on
};

/// deg/s, at this time of the world.
[[nodiscard]] inline double gyro_bias_deg_per_s(const GyroModel& model, const Noise& noise,
                                                double time_s) noexcept {
  return model.bias_deg_per_s * noise.constant(0) +
         model.wander_deg_per_s * slow_noise(noise, time_s / 60, 1);
}

/// rad/s, left positive, in steps of the part's digit; beyond its range the end of it.
[[nodiscard]] inline float gyro_reading(const GyroModel& model, const Noise& noise,
                                        const GyroSample& sample) noexcept {
  const double rate = sample.turn_rad_per_s / degree;
  const double lost = model.most_lost * std::abs(rate) / (std::abs(rate) + model.half_lost_at_deg_per_s);
  const double spread = sample.driving ? model.driving_noise_deg_per_s : model.noise_deg_per_s;
  const double time_s =
      static_cast<double>(sample.number) * std::chrono::duration<double>(model.period).count();
  const double measured =
      rate * (1 - lost) + gyro_bias_deg_per_s(model, noise, time_s) + spread * noise.normal(sample.number, 2);
  const double most = std::floor(model.range_deg_per_s / model.deg_per_s_per_digit);
  const auto count = digits<std::int32_t>(measured / model.deg_per_s_per_digit, -most, most);
  return static_cast<float>(count * model.deg_per_s_per_digit * degree);
}

// Compass

struct CompassSample {
  std::uint64_t number = 0;
  Vector field_gauss{};  ///< in the world, where the compass is
  double heading_rad = 0;
};

/// The robot's own magnetism, in its frame, gauss.
[[nodiscard]] inline Vector own_field(const CompassModel& model, const Noise& noise) noexcept {
  return Vector{noise.constant(0), noise.constant(1)} * model.own_field_gauss;
}

/// Gauss, x ahead, y left, in steps of the part's digit; beyond its range the end of it.
[[nodiscard]] inline sensing::Field compass_reading(const CompassModel& model, const Noise& noise,
                                                    const CompassSample& sample) noexcept {
  const Vector ahead = direction(sample.heading_rad);
  const Vector own = own_field(model, noise);
  const auto axis = [&](double gauss, std::uint8_t channel) {
    const double measured = gauss + model.noise_gauss * noise.normal(sample.number, channel);
    const auto count =
        digits<std::int32_t>(measured * model.counts_per_gauss, -model.most_counts - 1, model.most_counts);
    return static_cast<float>(count / model.counts_per_gauss);
  };
  return {axis(dot(ahead, sample.field_gauss) + own.x, 2), axis(cross(ahead, sample.field_gauss) + own.y, 3)};
}

// Distance sensors

/// A robot as others see it and bump into it.
struct Disc {
  Vector centre{};
  double radius_m = 0;
};

/// How far a ray from `origin` goes until it enters the disc; 0 from inside, infinity when it misses. `ray`
/// has length 1.
[[nodiscard]] inline double distance_along(Vector origin, Vector ray, const Disc& disc) noexcept {
  const Vector to_centre = disc.centre - origin;
  const double along = dot(to_centre, ray);
  const double square = dot(to_centre, to_centre) - disc.radius_m * disc.radius_m;
  if (square <= 0) return 0;
  const double half_chord = along * along - square;
  if (along < 0 || half_chord < 0) return std::numeric_limits<double>::infinity();
  return along - std::sqrt(half_chord);
}

struct InfraredSample {
  std::uint64_t number = 0;
  std::array<double, sensing::tower_sensors> distance_m{};  ///< infinity: nothing there
};

/// Volts of one sensor, in steps of the converter. Beyond 80 cm the curve goes on to its end; below 5 cm it
/// reads like far away. [T2 §5.3]
[[nodiscard]] inline float infrared_reading(const InfraredModel& model, const Noise& noise,
                                            const InfraredSample& sample, std::size_t sensor) noexcept {
  const auto channel = static_cast<std::uint8_t>(3 * sensor);
  const double slope = 1 + model.slope_spread * noise.constant(channel);
  const double offset = model.offset_spread_v * noise.constant(static_cast<std::uint8_t>(channel + 1));
  const sensing::IrCurve curve{static_cast<float>(model.curve.slope_v_cm * slope),
                               static_cast<float>(model.curve.offset_v + offset)};
  const auto centimetres = static_cast<float>(sample.distance_m[sensor] * 100);
  const double volts = sensing::ir_volts(centimetres, curve) +
                       model.noise_v * noise.normal(sample.number, static_cast<std::uint8_t>(channel + 2));
  const double most = (std::uint32_t{1} << model.converter_bits) - 1;
  const auto count = digits<std::uint32_t>(volts / model.converter_reference_v * most, 0, most);
  return sensing::adc_volts(count, model.converter_bits, model.converter_reference_v);
}

}  // namespace ocm::sim::mapper
