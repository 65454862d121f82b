#include "ocm/mapper/app/models.hpp"

#include <catch2/catch.hpp>

#include "unit/motion/near.hpp"

namespace mapper_app_models_test {

using namespace ocm;
using namespace std::chrono_literals;
using mapper::app::arduino_robot;
using mapper::app::avr_robot;
using ocm::test::near;

// [T2 §11.2.3; tables 9.2, 9.3]
static_assert(avr_robot.estimator.drive.ticks_per_turn == 198.0F && avr_robot.motors.most_ticks_s == 66.0F);
static_assert(arduino_robot.estimator.drive.ticks_per_turn == 2475.0F &&
              arduino_robot.motors.most_ticks_s == 1250.0F);
static_assert(avr_robot.periods.estimator == 30ms && avr_robot.periods.movement == 20ms &&
              avr_robot.periods.tower == 200ms);
// Tuned in the simulation: of an error of 100 ticks/s 6 % effort at once, and as much again in 75 ms.
// [decided]
static_assert(arduino_robot.motors.wheel_pi.pi.kp == 6e-4F && arduino_robot.motors.wheel_pi.pi.ki == 8e-3F &&
              arduino_robot.motors.wheel_pi.starting_effort == 0.3F);
// So is what follows. [decided]
constexpr auto& turns = mapper::app::detail::heading_pid;
static_assert(turns.kp == 2.0F && turns.ki == 0.2F && turns.kd == 0.05F &&
              turns.derivative_filter_s == 0.05F && turns.derivative_of_reference == 1.0F);
constexpr auto& drives = mapper::app::detail::distance_pid;
static_assert(drives.kp == 5.0F && drives.ki == 0.2F && drives.kd == 0.1F &&
              drives.derivative_filter_s == 0.05F && drives.derivative_of_reference == 1.0F);
static_assert(avr_robot.controller.heading.kp == turns.kp && avr_robot.controller.distance.kp == drives.kp);
static_assert(avr_robot.controller.heading_tolerance_rad == motion::radians(2.0F) &&
              arduino_robot.controller.heading_tolerance_rad == motion::radians(1.0F) &&
              avr_robot.controller.distance_tolerance_m == 0.01F);
static_assert(avr_robot.controller.distance.least == -1.0F && avr_robot.controller.distance.most == 1.0F);
static_assert(arduino_robot.controller.distance.least == -0.8F &&
              arduino_robot.controller.distance.most == 0.8F);
static_assert(avr_robot.estimator.heading.gyro_threshold_rad_s == motion::radians(0.5F) &&
              avr_robot.estimator.heading.gyro_variance_rad2_per_s == 2e-4F);
static_assert(avr_robot.estimator.compass_variance_rad2 == 0.5F && avr_robot.estimator.compass_gate == 2.0F);
static_assert(avr_robot.minimum_distance_cm == 15 && avr_robot.compass.calibration_effort == 0.5F &&
              avr_robot.measuring.moving_rad_s == motion::radians(20.0F));
static_assert(avr_robot.estimator.most_ticks == 66 && arduino_robot.estimator.most_ticks == 1250,
              "what a wheel makes in a second");
static_assert(avr_robot.estimator.drive.wheel_radius_m == 0.033F &&
              avr_robot.estimator.drive.wheelbase_m == 0.15F);
static_assert(arduino_robot.estimator.drive.wheel_radius_m == 0.028F &&
              arduino_robot.estimator.drive.wheelbase_m == 0.15F);
static_assert(arduino_robot.motors.wheel_pi.pi.least == 0.0F &&
              arduino_robot.motors.wheel_pi.pi.most == 1.0F);
static_assert(avr_robot.handshake.axle_offset == 1 && avr_robot.handshake.tower_offset == 3);
static_assert(arduino_robot.handshake.axle_offset == 4 && arduino_robot.handshake.tower_offset == 0,
              "its gears move the axle forwards");  // [T2 §11.2.1]
static_assert(avr_robot.periods.supervision == 100ms && avr_robot.periods.communication_apart == 20ms);
static_assert(avr_robot.times.handshake == 1s && avr_robot.times.idle == 1s);
static_assert(avr_robot.times.command_lives == 200ms && avr_robot.times.calibration_limit == 60s);
static_assert(avr_robot.measuring.samples == 64 && avr_robot.measuring.failures == 10);
static_assert(avr_robot.times.return_after == 0s, "a robot that comes home by itself has to be asked for");
static_assert(avr_robot.motors.kind == mapper::app::MotorKind::gated);      // [T2 §7.1, §10.2.3]
static_assert(arduino_robot.motors.kind == mapper::app::MotorKind::paced);  // [T2 §7.1.1]

TEST_CASE("mapper models: what every model must be", "[mapper_models]") {
  for (const mapper::app::RobotModel* model : {&avr_robot, &arduino_robot}) {
    CHECK(model->estimator.drive.valid());
    CHECK(model->estimator.heading.gyro_weight == 0.75F);  // [T2 §7.3]
    CHECK(model->estimator.compass_variance_rad2 > 0.0F);
    CHECK(mapper::link::write(model->handshake).ok());
    // A step of the estimator may be late a few times over before it loses ticks.
    CHECK(static_cast<float>(model->estimator.most_ticks) > 3 * 0.030F * model->motors.most_ticks_s);
    // Idle says within the deadline that the robot is there.
    CHECK(model->handshake.deadline > 2000);
    CHECK(model->minimum_distance_cm >= 10);                        // the sensors' near end
    CHECK(model->measuring.moving_rad_s > motion::radians(10.0F));  // zero-rate level of the part
  }
}

TEST_CASE("mapper models: the tower's sensors are where sensing has them", "[mapper_models]") {
  const sensing::Tower tower;
  const mapper::link::Handshake& handshake = avr_robot.handshake;
  const std::int16_t sent[] = {handshake.sensor1, handshake.sensor2, handshake.sensor3, handshake.sensor4};
  for (std::size_t i = 0; i < 4; ++i) CHECK(near(static_cast<float>(sent[i]), tower.sensor_heading_deg[i]));
}

TEST_CASE("mapper models: a calibration belongs to one robot, not to its type", "[mapper_models]") {
  CHECK_FALSE(avr_robot.compass.calibrated);
  const auto mine = calibrated(avr_robot, {0.1F, -0.2F});
  CHECK(mine.compass.calibrated);
  CHECK(mine.compass.offset == sensing::Field{0.1F, -0.2F});
  CHECK(mine.handshake == avr_robot.handshake);
}

TEST_CASE("mapper models: wheels that say too much of a way say the same of a turn", "[mapper_models]") {
  const auto& before = avr_robot.estimator.drive;
  const auto mine = wheels_calibrated(avr_robot, 1.025F);
  const auto& after = mine.estimator.drive;
  CHECK(after.valid());
  CHECK(near(after.m_per_tick() * 1.025F, before.m_per_tick()));
  CHECK(near(after.m_per_tick() / after.wheelbase_m, before.m_per_tick() / before.wheelbase_m));
}

}  // namespace mapper_app_models_test
