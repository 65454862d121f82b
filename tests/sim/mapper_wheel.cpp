#include <catch2/catch.hpp>

#include "sim/mapper/servo.hpp"
#include "sim/mapper/wheel.hpp"
#include "sim/physics/noise.hpp"

namespace sim_mapper_wheel_test {

using namespace ocm::sim;
using namespace ocm::sim::mapper;

constexpr MotorModel avr = avr_model.motor;
constexpr MotorModel arduino = arduino_model.motor;

double run(Wheel& wheel, double seconds) {
  double turned = 0;
  for (long i = std::lround(seconds / step_s); i > 0; --i) turned += wheel.step();
  return turned;
}

/// Ticks a second in the end, at this effort.
double speed_at(const MotorModel& motor, float effort) {
  Wheel wheel{motor, 0};
  wheel.drive(effort);
  run(wheel, 2);
  return wheel.ticks_per_s();
}

std::int32_t count(const Wheel& wheel) {
  return static_cast<std::int32_t>(wheel.ticks());
}

TEST_CASE("a motor of the AVR robot is dead below 40 %, and hardly faster at 100 % than at 40 %") {
  CHECK(speed_at(avr, 0.0F) == 0);
  CHECK(speed_at(avr, 0.39F) == 0);
  CHECK(speed_at(avr, -0.39F) == 0);
  // 0.4/0.02 (66 - v) = 0.6/0.12 v: v = 66 * 20/25.
  CHECK(speed_at(avr, 0.4F) == Approx(52.8).epsilon(0.001));
  CHECK(speed_at(avr, 1.0F) == Approx(66));
  CHECK(speed_at(avr, -1.0F) == Approx(-66));
}

TEST_CASE("switched on for 8 ms of 20 ms by a task, a motor goes as with an effort of 40 %") {
  Wheel wheel{avr, 0};
  double turned = 0;
  for (int slot = 0; slot < 100; ++slot) {
    if (slot == 50) turned = 0;
    wheel.drive(1.0F);
    turned += run(wheel, 0.008);
    wheel.drive(0.0F);
    turned += run(wheel, 0.012);
  }
  CHECK(turned == Approx(52.8 * 50 * 0.020).epsilon(0.02));
}

TEST_CASE("a motor of the Arduino robot goes as fast as its effort says") {
  CHECK(speed_at(arduino, 0.14F) == 0);
  CHECK(speed_at(arduino, 0.5F) == Approx(625));
  CHECK(speed_at(arduino, 1.0F) == Approx(1250));
}

TEST_CASE("efforts beyond the end are the end, and what is no number is off") {
  CHECK(speed_at(arduino, 7.0F) == Approx(1250));
  CHECK(speed_at(arduino, -7.0F) == Approx(-1250));
  CHECK(speed_at(arduino, std::numeric_limits<float>::infinity()) == Approx(1250));
  CHECK(speed_at(arduino, std::numeric_limits<float>::quiet_NaN()) == 0);
}

TEST_CASE("motors are at best as fast as the model's, and never less than half of it") {
  for (unsigned i = 0; i < 1000; ++i) {
    const Wheel wheel{arduino, Noise{1, 0}.normal(i, 0)};
    CHECK(wheel.full_ticks_per_s() <= 1250);
    CHECK(wheel.full_ticks_per_s() >= 625);
  }
  CHECK(Wheel{arduino, -6}.full_ticks_per_s() == Approx(650));  // 1250 * (1 - 6 * 0.08)
}

TEST_CASE("it starts with a lag and rolls out with another") {
  Wheel wheel{avr, 0};
  wheel.drive(1.0F);
  run(wheel, 0.02);
  CHECK(wheel.ticks_per_s() == Approx(66 * (1 - std::exp(-1.0))).epsilon(0.03));
  run(wheel, 1);
  wheel.drive(0.0F);
  run(wheel, 0.12);
  CHECK(wheel.ticks_per_s() == Approx(66 * std::exp(-1.0)).epsilon(0.03));
  CHECK_FALSE(wheel.at_rest());
  run(wheel, 1);  // friction stops it at 2 %, after 0.12 * ln 50 = 0.47 s
  CHECK(wheel.at_rest());
  CHECK(wheel.ticks_per_s() == 0);
}

TEST_CASE("an encoder counts whole ticks, each once") {
  Wheel wheel{avr, 0};
  wheel.drive(1.0F);
  double turned = 0;
  for (int i = 0; i < 60'000; ++i) {
    turned += wheel.step();
    REQUIRE(count(wheel) == static_cast<std::int32_t>(std::floor(turned)));
  }
  CHECK(count(wheel) == Approx(66 * 60).margin(3));
}

TEST_CASE("what rolls out counts the way of the last command; before the first nothing counts") {
  Wheel wheel{avr, 0};
  CHECK(count(wheel) == 0);
  wheel.drive(-1.0F);
  run(wheel, 1);
  const std::int32_t driven = count(wheel);
  CHECK(driven < -60);
  wheel.drive(0.0F);
  run(wheel, 1);
  CHECK(count(wheel) <= driven - 7);  // 66 * 0.12 = 7.9 ticks
  CHECK(count(wheel) >= driven - 9);
}

TEST_CASE("a wheel that is reversed counts the new way while it still turns the old") {
  Wheel wheel{avr, 0};
  wheel.drive(1.0F);
  run(wheel, 5);
  const std::int32_t before = count(wheel);
  wheel.drive(-0.3F);  // too little to turn it: it rolls out forwards, but its command is backwards
  const double rolled = run(wheel, 1);
  CHECK(rolled > 7);
  CHECK(count(wheel) == Approx(before - rolled).margin(1));
}

TEST_CASE("ticks go one way with the command, whatever the efforts") {
  const Noise noise{3, 0};
  Wheel wheel{avr, 0};
  bool forward = true;
  wheel.drive(1.0F);
  run(wheel, 1);
  for (unsigned i = 0; i < 500; ++i) {
    const auto effort = static_cast<float>(noise.normal(i, 0));
    wheel.drive(effort);
    if (effort > 0) forward = true;
    if (effort < 0) forward = false;
    for (int ms = 0; ms < 30; ++ms) {
      const std::int32_t before = count(wheel);
      wheel.step();
      REQUIRE((forward ? count(wheel) - before : before - count(wheel)) >= 0);
    }
  }
}

TEST_CASE("the servo goes at its greatest speed, then settles, and stays") {
  Servo servo{ServoModel{}};
  CHECK(servo.at_rest());
  servo.turn(90);
  CHECK(servo.angle_deg() == 0);  // not at once
  for (int ms = 0; ms < 100; ++ms) servo.step();
  CHECK(servo.angle_deg() == Approx(60));  // 0.1 s for 60 degrees
  // The last 18 degrees (600 deg/s * 30 ms) with the lag: 120 ms in all, then e-fold each 30 ms.
  for (int ms = 0; ms < 50; ++ms) servo.step();
  CHECK(servo.angle_deg() == Approx(90 - 18 * std::exp(-30.0 / 30)).margin(0.5));
  for (int ms = 0; ms < 300; ++ms) servo.step();
  CHECK(servo.at_rest());
  CHECK(servo.angle_deg() == 90);
}

TEST_CASE("a motor's speed follows its equation, between off and full, and its least effort turns it") {
  // dv/dt = e (full - v)/start - (1 - e) v/stop: in the end e full/start / (e/start + (1 - e)/stop).
  for (const float effort : {0.4F, 0.5F, 0.75F, 0.9F, -0.6F}) {
    const double e = std::abs(effort), end = e * 66 / 0.02 / (e / 0.02 + (1 - e) / 0.12);
    CHECK(speed_at(avr, effort) == Approx(effort < 0 ? -end : end).epsilon(1e-3));
  }
  CHECK(speed_at(arduino, 0.15F) == Approx(1250 * 0.15).epsilon(1e-3));
  Wheel wheel{avr, 0};
  wheel.drive(0.5F);
  CHECK(wheel.powered());
  CHECK_FALSE(wheel.at_rest());
  run(wheel, 0.02);
  wheel.drive(0.0F);
  CHECK_FALSE(wheel.powered());
  CHECK_FALSE(wheel.at_rest());
  // Friction stops it at 2 % of its full speed, not above, and not with voltage on.
  double slowest = 66;
  while (!wheel.at_rest()) {
    slowest = std::abs(wheel.ticks_per_s());
    wheel.step();
  }
  CHECK(slowest == Approx(0.02 * 66).epsilon(0.02));
  wheel.drive(1.0F);
  wheel.step();
  CHECK(wheel.ticks_per_s() > 0);
}

TEST_CASE("a step of the tower has settled within its 200 ms") {
  Servo servo{ServoModel{}};
  servo.turn(10);
  for (int ms = 0; ms < 20; ++ms) servo.step();
  CHECK(servo.angle_deg() < 6);
  for (int ms = 20; ms < 200; ++ms) servo.step();
  CHECK(servo.angle_deg() == Approx(10).margin(0.05));
  servo.turn(500);
  for (int ms = 0; ms < 1000; ++ms) servo.step();
  CHECK(servo.angle_deg() == 90);
  servo.turn(-500);
  for (int ms = 0; ms < 1000; ++ms) servo.step();
  CHECK(servo.angle_deg() == 0);
}

}  // namespace sim_mapper_wheel_test
