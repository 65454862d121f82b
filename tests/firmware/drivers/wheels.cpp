#include <array>
#include <cmath>
#include <cstdlib>

#include <catch2/catch.hpp>

#include "firmware/drivers/motor.hpp"
#include "firmware/drivers/wheel_controller.hpp"
#include "tests/firmware/drivers/fixture.hpp"

namespace firmware_drivers_wheels_test {

using namespace drivers_tests;
using namespace ocm::firmware::drivers;

constexpr std::int32_t full_speed = 20595;  // as boards/di_wheel_drive/parts.hpp has it

/// A motor with its wheel: a lag, a friction that has to be overcome, whole ticks.
struct Wheel {
  double full_ticks = 20595 / 256.0;  // a step of 10 ms at full duty
  double lag_steps = 5;
  double friction = 0;  // part of full duty
  double speed = 0, way = 0;
  bool held = false;
  std::int32_t ticks = 0;

  /// Ticks in the next 10 ms.
  std::int16_t step(std::int16_t duty) {
    double drive = duty / 32767.0;
    drive = std::abs(drive) < friction ? 0 : drive - std::copysign(friction, drive);
    speed += (drive * full_ticks - speed) * (1 - std::exp(-1 / lag_steps));
    if (held) speed = 0;
    way += speed;
    const auto now = static_cast<std::int32_t>(std::floor(way));
    const auto moved = static_cast<std::int16_t>(now - ticks);
    ticks = now;
    return moved;
  }
};

struct Loop {
  WheelController controller{WheelGains::for_full_speed(full_speed)};
  Wheel wheel{};
  std::int16_t moved = 0;
  std::int16_t duty = 0;
  double step(std::int16_t speed) {
    duty = controller.step(speed, moved);
    moved = wheel.step(duty);
    return wheel.speed * 256;
  }
};

TEST_CASE("totals go on where the counter wraps, both ways") {
  WheelCounter counter;
  CHECK(counter.sample(65500) == 0);
  CHECK(counter.total(65500) == -36);
  CHECK(counter.sample(20) == 56);
  CHECK(counter.total(20) == 20);
  CHECK(counter.sample(65530) == -26);
  CHECK(counter.total(65530) == -6);
  CHECK(counter.total(10) == 10);  // what came since, without a sample
  std::int32_t total = -6;
  std::uint16_t raw = 65530;
  for (int i = 0; i < 100; ++i) {
    raw = static_cast<std::uint16_t>(raw + 32767);
    total += 32767;
    CHECK(counter.total(raw) == total);
    CHECK(counter.sample(raw) == 32767);
    REQUIRE(counter.total(raw) == total);
  }
  for (int i = 0; i < 200; ++i) {
    raw = static_cast<std::uint16_t>(raw - 32768);
    total -= 32768;
    CHECK(counter.sample(raw) == -32768);
    REQUIRE(counter.total(raw) == total);
  }
}

TEST_CASE("a wheel reaches its set point and keeps to the way, whatever its motor") {
  struct Case {
    double strength, lag, friction;
  };
  const auto c = GENERATE(Case{1, 5, 0}, Case{0.7, 5, 0}, Case{1.4, 5, 0}, Case{1, 2, 0}, Case{1, 10, 0},
                          Case{0.8, 5, 0.05});
  CAPTURE(c.strength, c.lag, c.friction);
  const std::int16_t speed = GENERATE(as<std::int16_t>{}, 1030, 5000, -5000, 12000);
  CAPTURE(speed);
  Loop loop;
  loop.wheel.full_ticks *= c.strength;
  loop.wheel.lag_steps = c.lag;
  loop.wheel.friction = c.friction;
  for (int i = 0; i < 100; ++i) loop.step(speed);  // 1 s
  const double before = loop.wheel.way;
  for (int i = 0; i < 400; ++i) loop.step(speed);
  // Over 4 s the way is the asked one, to two ticks.
  CHECK(loop.wheel.way - before == Approx(speed / 256.0 * 400).margin(2.5));
  // What the integral holds is what the motor needs beyond what is taken for granted.
  const double needed = speed / c.strength + std::copysign(c.friction * full_speed, speed) - speed;
  CHECK(loop.controller.way() == Approx(10 * needed).margin(3000));
}

TEST_CASE("a step: quick, and without much overshoot") {
  Loop loop;
  double most = 0;
  int reached = 0;
  for (int i = 0; i < 100; ++i) {
    const double speed = loop.step(8000);
    most = std::max(most, speed);
    if (reached == 0 && speed >= 0.9 * 8000) reached = i;
  }
  CHECK(reached <= 15);
  CHECK(most < 1.15 * 8000);
}

TEST_CASE("an integral at full duty does not wind up") {
  Loop loop;
  loop.wheel.full_ticks *= 0.5;  // a motor that cannot
  for (int i = 0; i < 1000; ++i) loop.step(16000);
  CHECK(loop.duty == full_duty);
  // 10 s at half of what was asked. What would be missing is 8000 * 1000; kept is what full duty needs.
  CHECK(loop.controller.way() < 250'000);
  const double top = loop.wheel.speed * 256;
  int steps = 0;  // now less is asked than it can: it must come down at once, not make up for lost way
  while (loop.step(5000) > 1.1 * 5000 && steps < 1000) ++steps;
  CHECK(top > 9000);
  CHECK(steps < 60);
}

TEST_CASE("held and let go: no run-away") {
  Loop loop;
  for (int i = 0; i < 100; ++i) loop.step(4000);
  loop.wheel.held = true;
  for (int i = 0; i < 500; ++i) loop.step(4000);  // 5 s against a hand
  CHECK(loop.duty == full_duty);
  loop.wheel.held = false;
  double sum = 0;
  for (int i = 0; i < 100; ++i) sum += loop.step(4000);
  // It makes up for what full duty had in store, not for 5 s: those would be 2 million.
  CHECK(sum - 100 * 4000.0 < 400'000);
  CHECK(loop.step(4000) == Approx(4000).margin(400));
}

TEST_CASE("stop: at rest, without a voltage, and the missing way is forgotten") {
  Loop loop;
  for (int i = 0; i < 100; ++i) loop.step(8000);
  int steps = 0;
  while (std::abs(loop.step(0)) > 100 && steps < 200) ++steps;
  CHECK(steps < 40);
  for (int i = 0; i < 100; ++i) loop.step(0);
  CHECK(loop.duty == 0);
  CHECK(loop.moved == 0);
  CHECK(loop.controller.way() == 0);
}

TEST_CASE("the ends: no overflow anywhere") {
  WheelController controller{WheelGains::for_full_speed(full_speed)};
  for (int i = 0; i < 200'000; ++i) (void)controller.step(32767, -32768);
  CHECK(controller.step(32767, -32768) == full_duty);
  CHECK(controller.step(-32768, 32767) == -full_duty);
  for (int i = 0; i < 200'000; ++i) (void)controller.step(-32768, 32767);
  CHECK(controller.step(-32768, 32767) == -full_duty);
  CHECK(controller.step(0, 0) == 0);
}

}  // namespace firmware_drivers_wheels_test
