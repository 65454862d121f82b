/// The world of one simulated robot: its body, its surroundings, its batteries and its sensors.
///
/// Time is handed in and only goes forwards, in steps of 1 ms. What a sensor reads depends on the seed, the
/// commands with their times, and the time of reading: on nothing else, so reading does not disturb, and no
/// sensor disturbs another. A part delivers something new once in its period; in between it repeats itself.
///
/// Host only (the walls are in a std::vector). A step of a moving robot costs about 0.2 us; a robot at rest
/// costs next to nothing, however much time passes.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"

#include "firmware/boards/samples.hpp"
#include "sim/amiro/arena.hpp"
#include "sim/amiro/battery.hpp"
#include "sim/amiro/drive.hpp"
#include "sim/amiro/inertial.hpp"
#include "sim/amiro/proximity.hpp"
#include "sim/physics/step.hpp"

namespace ocm::sim {

/// What can be taken out of the robot.
enum class Part : std::uint8_t { gyroscope, accelerometer, magnetometer, floor, ring, encoders, gauge };
inline constexpr std::size_t part_count = 7;

struct WorldOptions {
  std::uint64_t seed = 1;
  base::Time start_time{};  ///< the world's time zero
  Pose start = default_start;
  Arena arena = default_arena();
  double state_of_charge = 0.9;  ///< 0..1
  bool plugged = false;
  /// Time is frozen: nothing moves, drains or is noisy; every read gives the same for ever.
  bool frozen = false;
  DriveModel drive{};
  PowerModel power{};
  GyroscopeModel gyroscope{};
  AccelerometerModel accelerometer{};
  MagnetometerModel magnetometer{};
  RingModel ring{};
  FloorModel floor{};
};

class World {
 public:
  static constexpr std::size_t lights = 8;

  explicit World(WorldOptions options = {})
      : options_(std::move(options)),
        drive_(options_.drive, options_.start),
        battery_(options_.power, options_.state_of_charge, options_.plugged),
        floor_offset_(options_.floor.offset_counts) {
    for (std::size_t i = 0; i < ring_offset_.size(); ++i)
      ring_offset_[i] = static_cast<std::uint16_t>(std::lround(options_.ring.offset_counts[i]));
    sampled_.fill({drive_.motion(), 0});
  }

  /// Lets time pass up to the last whole millisecond; a time before that is ignored.
  void advance_to(base::Time now) noexcept {
    if (options_.frozen) return;
    const std::int64_t until = (now - options_.start_time) / step;
    while (elapsed_ms_ < until) {
      std::int64_t duration_ms = 1;
      if (drive_.at_rest()) {  // on to the next look of the gauge in one go
        duration_ms = std::min(until, (elapsed_ms_ / 1000 + 1) * 1000) - elapsed_ms_;
      } else {
        drive_.step(options_.arena.walls, !battery_.empty());
      }
      battery_.step(load_mw(), duration_ms);
      elapsed_ms_ += duration_ms;
      if (elapsed_ms_ % 1000 == 0) battery_.gauge();
      take_samples();
    }
  }

  // --- what the robot does to the world ---

  /// Set points of speed controllers that keep to them.
  void set_wheels(firmware::boards::WheelSpeeds speeds) noexcept { drive_.set(speeds); }
  /// Voltages of the motors by themselves, -1..1 of all: in the end a wheel goes that part of its greatest
  /// speed. The caller of these controls the speeds itself.
  void set_duty(double left, double right) noexcept {
    drive_.set({left * options_.drive.greatest_speed_m_per_s, right * options_.drive.greatest_speed_m_per_s});
  }
  /// @param light 0..7; others are ignored
  void set_light(std::size_t light, Colour colour) noexcept {
    if (light < lights) lights_[light] = colour;
  }

  /// What the floor's sensors see now is what they see with nothing below them; or nothing is known of that.
  base::Status calibrate_floor(bool forget) noexcept {
    const auto raw = raw_floor();
    if (!raw && !forget) return raw.error;
    floor_offset_ = forget ? firmware::boards::FloorCounts{} : *raw;
    return {};
  }
  /// The same for the ring. Its counts keep the offset: it is stored for others.
  base::Status calibrate_ring(bool forget) noexcept {
    const auto counts = ring();
    if (!counts && !forget) return counts.error;
    ring_offset_ = forget ? firmware::boards::RingCounts{} : *counts;
    return {};
  }

  // --- what others do to it ---

  void set_plugged(bool plugged) noexcept { battery_.set_plugged(plugged); }
  /// An absent part delivers no sample until it is put back.
  void set_absent(Part part, bool absent) noexcept { absent_[index(part)] = absent; }

  // --- what an onlooker sees ---

  [[nodiscard]] const Motion& motion() const noexcept { return drive_.motion(); }
  [[nodiscard]] const Pose& pose() const noexcept { return drive_.motion().pose; }
  [[nodiscard]] firmware::boards::WheelSpeeds wheels() const noexcept { return drive_.wheels(); }
  /// The robot pushes against a wall.
  [[nodiscard]] bool touching() const noexcept { return drive_.touching(); }
  [[nodiscard]] Colour light(std::size_t light) const noexcept { return lights_[light]; }
  [[nodiscard]] const Battery& battery() const noexcept { return battery_; }
  [[nodiscard]] const WorldOptions& options() const noexcept { return options_; }
  [[nodiscard]] base::Time time() const noexcept { return options_.start_time + elapsed_ms_ * step; }

  // --- what the parts deliver; Error::not_sampled when they are absent ---

  [[nodiscard]] base::Result<firmware::boards::AngularRate> gyroscope() const noexcept {
    if (absent(Part::gyroscope)) return base::Error::not_sampled;
    return options_.gyroscope.read(sample(Part::gyroscope));
  }
  [[nodiscard]] base::Result<firmware::boards::SpecificForce> accelerometer() const noexcept {
    if (absent(Part::accelerometer)) return base::Error::not_sampled;
    return options_.accelerometer.read(sample(Part::accelerometer));
  }
  [[nodiscard]] base::Result<firmware::boards::MagneticField> magnetometer() const noexcept {
    if (absent(Part::magnetometer)) return base::Error::not_sampled;
    return options_.magnetometer.read(options_.arena, sample(Part::magnetometer));
  }
  [[nodiscard]] base::Result<firmware::boards::FloorCounts> floor() const noexcept {
    auto counts = raw_floor();
    if (!counts) return counts;
    for (std::size_t i = 0; i < counts->size(); ++i) {
      std::uint16_t& count = (*counts)[i];
      count = static_cast<std::uint16_t>(count > floor_offset_[i] ? count - floor_offset_[i] : 0);
    }
    return counts;
  }
  /// Before the offset is taken off.
  [[nodiscard]] base::Result<firmware::boards::FloorCounts> raw_floor() const noexcept {
    if (absent(Part::floor)) return base::Error::not_sampled;
    firmware::boards::FloorCounts counts = options_.floor.read(options_.arena, sample(Part::floor));
    for (std::size_t i = 0; i < counts.size(); ++i)
      counts[i] = static_cast<std::uint16_t>(counts[i] + options_.floor.offset_counts[i]);
    return counts;
  }
  [[nodiscard]] base::Result<firmware::boards::RingCounts> ring() const noexcept {
    if (absent(Part::ring)) return base::Error::not_sampled;
    return options_.ring.read(options_.arena.walls, sample(Part::ring));
  }
  [[nodiscard]] base::Result<firmware::boards::WheelTicks> encoders() const noexcept {
    if (absent(Part::encoders)) return base::Error::not_sampled;
    return drive_.ticks();
  }
  [[nodiscard]] base::Result<GaugeReading> gauge() const noexcept {
    if (absent(Part::gauge)) return base::Error::not_sampled;
    return battery_.reading();
  }
  [[nodiscard]] base::Result<firmware::boards::BatteryReadings> batteries() const noexcept {
    if (absent(Part::gauge)) return base::Error::not_sampled;
    return battery_.readings();
  }
  /// A room that is lit evenly from above.
  [[nodiscard]] base::Result<firmware::boards::RingLight> ring_light() const noexcept {
    if (absent(Part::ring)) return base::Error::not_sampled;
    firmware::boards::RingLight light{};
    light.fill(ambient_counts);
    return light;
  }

  [[nodiscard]] const firmware::boards::RingCounts& ring_offset() const noexcept { return ring_offset_; }
  /// Of one sensor, 0..7, as a board asks.
  [[nodiscard]] std::uint16_t ring_offset(std::size_t sensor) const noexcept { return ring_offset_[sensor]; }

  /// The newest sample of a part, as its model gets it.
  [[nodiscard]] Sample sample(Part part) const noexcept {
    const Sampled& newest = sampled_[index(part)];
    return {newest.motion, newest.number, Noise{options_.seed, index(part)}, !options_.frozen};
  }

 private:
  static constexpr base::Duration step = step_length;

  struct Sampled {
    Motion motion{};
    std::uint64_t number = 0;
  };

  [[nodiscard]] static constexpr std::size_t index(Part part) noexcept {
    return static_cast<std::size_t>(part);
  }
  [[nodiscard]] bool absent(Part part) const noexcept { return absent_[index(part)]; }

  /// Each part with a new sample since the last step takes it now: at the end of the step in which it fell.
  void take_samples() noexcept {
    const base::Duration elapsed = elapsed_ms_ * step;
    const auto take = [&](Part part, base::Duration period) {
      const auto number = static_cast<std::uint64_t>(elapsed / period);
      Sampled& newest = sampled_[index(part)];
      if (number != newest.number) newest = {drive_.motion(), number};
    };
    take(Part::gyroscope, options_.gyroscope.period);
    take(Part::accelerometer, options_.accelerometer.period);
    take(Part::magnetometer, options_.magnetometer.period);
    take(Part::floor, proximity_period);
    take(Part::ring, proximity_period);
  }

  [[nodiscard]] std::int64_t load_mw() const noexcept {
    const PowerModel& power = options_.power;
    const firmware::boards::WheelSpeeds wheels = drive_.wheels();
    const double wheel_part =
        (std::abs(wheels.left) + std::abs(wheels.right)) / options_.drive.greatest_speed_m_per_s;
    std::int64_t brightness = 0;
    for (const Colour& light : lights_) brightness += light.red + light.green + light.blue;
    return power.boards_mw + std::llround(wheel_part * static_cast<double>(power.motor_mw)) +
           brightness * power.light_mw / 255;
  }

  WorldOptions options_;
  Drive drive_;
  Battery battery_;
  std::array<Sampled, part_count> sampled_{};
  firmware::boards::FloorCounts floor_offset_;  // what is taken for the floor sensors' offset
  firmware::boards::RingCounts ring_offset_{};
  std::array<bool, part_count> absent_{};
  std::array<Colour, lights> lights_{};
  std::int64_t elapsed_ms_ = 0;
};

}  // namespace ocm::sim
