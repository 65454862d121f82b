/// What a mapper is like: its size, its motors, its sensors, and how each of them errs. Two sets of
/// figures: the AVR robot and the Arduino robot of thesis 2 ("T2").
///
/// Every figure has its source. "[decided]" is ours: the thesis gives no size. The errors of wheels and gyro
/// were chosen from the thesis and from data sheets before any estimate was made of them; docs/simulation.md
/// says how. `spread` is the standard deviation from part to part, drawn once for each robot by its seed.
#pragma once

#include <chrono>
#include <cstdint>

#include "ocm/base/time.hpp"
#include "ocm/motion/pose.hpp"
#include "ocm/sensing/ir_sensor.hpp"
#include "ocm/sensing/tower.hpp"

#include "sim/physics/geometry.hpp"

namespace ocm::sim::mapper {

enum class RobotKind : std::uint8_t { avr, arduino };

struct BodyModel {
  double radius_m = 0.10;         ///< a disc around all of it [decided]
  double centre_ahead_m = -0.01;  ///< middle of the disc, as seen from the axle [T2 §17.1: small; decided]
};

/// A wheel's speed v follows its motor's effort e, 0 to 1 of the time with voltage on:
///
///     dv/dt = e (full - v)/start - (1 - e) v/stop
///
/// The same whether the effort is a level or switched on and off by a task.
struct MotorModel {
  double full_ticks_per_s = 66;  ///< of the best motor [T2 §11.2.3]
  double least_effort = 0.4;     ///< less does not turn it [T2 §10.2.3]
  double start_s = 0.02;     ///< with voltage; with stop_s it makes 80 % of the speed of 40 % [T2 §10.2.3]
  double stop_s = 0.12;      ///< without: rolling out [decided]
  double standstill = 0.02;  ///< part of full speed at which friction stops it [decided]
  double spread = 0.02;      ///< of full speed, as a part of it [decided]
};

/// Wheels turn more than the robot gets on, and more so when it rotates. [T2 §7.3, §16.3]
struct SlipModel {
  /// What the wheels say too much of a turn, on a floor of `friction`. Gyro weight a = 0.75 made the estimate
  /// right (eq. 7.5), so it is three times what the gyro says too little. [T2 §7.3; size decided]
  double turning = 0.10;
  /// What they say too much of a way. [T2 table 13.1: legs 2 to 4 are estimated 3.2, 2.5 and 3.0 % too long]
  double straight = 0.025;
  double friction = 0.5;     ///< where that holds; slip goes with 1/friction [T2 §7.3; law and size decided]
  double variation = 0.25;   ///< of the slip itself, from place to place [decided]
  double variation_s = 0.5;  ///< how long a place is [decided]
};

/// Against what the application believes of its wheels. [Decided: a straight leg bends by about a degree, as
/// the estimates of T2 table 13.1 do]
struct WheelErrors {
  double radius_spread = 0.002;
  double wheelbase_spread = 0.005;
};

/// LSM6DS3 at +-245 deg/s, 416 samples/s, high-performance mode.
struct GyroModel {
  base::Duration period = std::chrono::microseconds{2404};
  double deg_per_s_per_digit = 0.00875;  ///< [data sheet]
  double range_deg_per_s = 245;          ///< [data sheet]
  double noise_deg_per_s = 0.10;         ///< 7 mdps/sqrt(Hz) over 208 Hz [data sheet]
  double driving_noise_deg_per_s = 0.3;  ///< with the motors on [T2 figure 7.3: more; size decided]
  double bias_deg_per_s = 3.3;     ///< zero-rate level within +-10 deg/s [data sheet, taken as 3 spreads]
  double wander_deg_per_s = 0.03;  ///< of the bias, from minute to minute [T2 §7.2.1: 1 to 3 deg/min]
  /// What it says too little, as a part of the turn rate: `most_lost * rate / (rate + half_lost_at)`, so not
  /// by a constant factor [T2 §7.3]. A third of the wheels' error at the AVR robot's turn rate of 48 deg/s,
  /// see there.
  double most_lost = 0.05;
  double half_lost_at_deg_per_s = 24;
};

/// HMC5883L at +-1.3 G, 75 samples/s.
struct CompassModel {
  base::Duration period = std::chrono::microseconds{13334};
  double counts_per_gauss = 1090;  ///< [data sheet]
  double most_counts = 2047;       ///< [data sheet: 12 bits]
  double noise_gauss = 0.002;      ///< [data sheet: resolution 2 mG; makes 0.8 deg in Trondheim's field]
  double own_field_gauss = 0.05;   ///< spread of the robot's own magnetism, each axis [decided]
};

/// Four GP2Y0A21YK on a converter of 10 bits.
struct InfraredModel {
  base::Duration period = std::chrono::microseconds{38300};  ///< a measurement takes so long [data sheet]
  sensing::IrCurve curve = sensing::typical_ir_curve;
  double noise_v = 0.02;  ///< 1.5 cm at 40 cm [T2 §5.3: "a couple of cm"]
  double offset_spread_v =
      0.01;                    ///< one table served all sensors, with a little bias [T2 §5.3; size decided]
  double slope_spread = 0.02;  ///< the same, in proportion [decided]
  unsigned converter_bits = 10;        ///< [ATmega1284P, ATmega2560 data sheets]
  float converter_reference_v = 5.0F;  ///< [decided]
};

/// SG90, the tower's servo. [T2 appendix: parts list]
struct ServoModel {
  double most_deg_per_s = 600;  ///< 0.1 s for 60 degrees [data sheet]
  double lag_s = 0.03;          ///< of the last bit of the way; settled in far less than 200 ms [decided]
};

struct RobotModel {
  RobotKind kind = RobotKind::avr;
  /// As the application believes it to be. Ticks of a turn: spec/conflicts.md. Wheel and base: [decided], of
  /// the size of hobby servos' wheels; they make 69 mm/s, so that a leg of 1.3 m takes 19 s.
  motion::Drive drive{.wheel_radius_m = 0.033F, .wheelbase_m = 0.15F, .ticks_per_turn = 198.0F};
  BodyModel body{};
  MotorModel motor{};
  SlipModel slip{};
  WheelErrors wheel_errors{};
  GyroModel gyro{};
  CompassModel compass{};
  InfraredModel infrared{};
  ServoModel servo{};
  sensing::Tower tower{.ahead_of_axle_m = 0.02F,  // [T2 §17.1: small; decided]
                       .sensor_heading_deg = {0.0F, 90.0F, 180.0F, 270.0F},
                       .sensor_out_m = {0.03F, 0.03F, 0.03F, 0.03F}};
};

inline constexpr RobotModel avr_model{};

/// Strong motors behind a gear, wheels with little grip, the axle far ahead. [T2 §11.2]
inline constexpr RobotModel arduino_model = [] {
  RobotModel model;
  model.kind = RobotKind::arduino;
  model.drive.wheel_radius_m = 0.028F;      // smaller: 89 mm/s [decided]
  model.drive.ticks_per_turn = 2475.0F;     // [T2 §11.2.3]
  model.body.centre_ahead_m = -0.04;        // [T2 §11.2.1: moved by the gears; size decided]
  model.tower.ahead_of_axle_m = -0.04F;     // [the same]
  model.motor = {.full_ticks_per_s = 1250,  // [T2 §11.2.3]
                 .least_effort = 0.15,      // [T2 §11.2.1: it needs some voltage to start; decided]
                 .start_s = 0.08,           // equal: the speed goes with the effort [decided]
                 .stop_s = 0.08,
                 .standstill = 0.02,
                 .spread = 0.08};  // [T2 §7.1: left and right differ much; size decided]
  model.slip.turning = 0.15;       // [T2 §11.2.1: little grip; size decided]
  return model;
}();

[[nodiscard]] constexpr const RobotModel& model_of(RobotKind kind) noexcept {
  return kind == RobotKind::avr ? avr_model : arduino_model;
}

}  // namespace ocm::sim::mapper
