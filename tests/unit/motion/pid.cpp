#include "ocm/motion/pid.hpp"

#include <limits>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"
#include "unit/motion/near.hpp"

namespace motion_pid_test {

using namespace ocm::motion;
using ocm::test::near;
using ocm::test::Random;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

constexpr PidModel wide(float kp, float ki, float kd) {
  return {.kp = kp, .ki = ki, .kd = kd, .least = -1000.0F, .most = 1000.0F};
}

// e = 2: P = 6; I = 0.5 * 2 * 0.1 = 0.1. Again: I = 0.2.
constexpr Pid first = control({}, 5.0F, 3.0F, 0.1F, wide(3.0F, 0.5F, 0.0F));
static_assert(near(first.output, 6.1F) && near(first.integral, 0.1F));
static_assert(near(control(first, 5.0F, 3.0F, 0.1F, wide(3.0F, 0.5F, 0.0F)).output, 6.2F));

// The integral takes the time that passed, not a period: e = 2 over 0.3 s after 0.1 s.
static_assert(near(control(first, 5.0F, 3.0F, 0.3F, wide(3.0F, 0.5F, 0.0F)).integral, 0.4F));

constexpr float derivative(float of_reference, float filter_s, float dt_s) {
  PidModel model = wide(0.0F, 0.0F, 1.0F);
  model.derivative_of_reference = of_reference;
  model.derivative_filter_s = filter_s;
  // The reference goes from 1 to 4, the measurement from 0 to 1.
  return control(control({}, 1.0F, 0.0F, dt_s, model), 4.0F, 1.0F, dt_s, model).output;
}
static_assert(near(derivative(0.0F, 0.0F, 0.5F), -2.0F), "of the measurement: -1 / 0.5");
static_assert(near(derivative(1.0F, 0.0F, 0.5F), 4.0F), "of the error: (3 - 1) / 0.5 [T2 §17.1]");
static_assert(near(derivative(1.0F, 0.0F, 0.25F), 8.0F), "over the time that passed");
static_assert(near(derivative(1.0F, 1.5F, 0.5F), 1.0F), "filtered: 0.5 / (1.5 + 0.5) of it");
static_assert(control({}, 5.0F, 3.0F, 0.1F, wide(0.0F, 0.0F, 1.0F)).output == 0.0F, "no kick at the start");
constexpr float fading() {
  PidModel model = wide(0.0F, 0.0F, 1.0F);
  model.derivative_filter_s = 1.5F;
  Pid pid{};
  for (const float measured : {0.0F, 1.0F, 1.0F}) pid = control(pid, 0.0F, measured, 0.5F, model);
  return pid.output;
}
static_assert(near(fading(), -0.375F), "a quarter of -2, and of that three quarters a step later");
// From 2 to 3 in half a second, whatever it was before: the next step derives from this one.
constexpr Pid second =
    control(control({}, 0.0F, 2.0F, 0.5F, wide(0.0F, 0.0F, 1.0F)), 0.0F, 3.0F, 0.5F, wide(0.0F, 0.0F, 1.0F));
static_assert(near(second.output, -2.0F) && second.measured == 3.0F && second.reference == 0.0F);

// What is not given is none: no gains, no filter, an effort within -1 and 1, clamping.
static_assert(control(control({}, 5.0F, 3.0F, 0.1F, {}), 6.0F, 2.0F, 0.1F, {}).output == 0.0F);
static_assert(control({}, 5.0F, 3.0F, 0.1F, {.kp = 1.0F}).output == 1.0F &&
              control({}, -5.0F, 3.0F, 0.1F, {.kp = 1.0F}).output == -1.0F);
static_assert(control({.integral = 0.5F}, 0.5F, 0.0F, 0.1F, {.kp = 1.0F, .ki = 2.0F}).integral == 0.5F);
static_assert(control({}, 5.0F, 0.0F, 0.1F, {.kp = 1.0F, .tracking_s = 0.2F}).integral == 0.0F,
              "without an integral there is nothing to take down");
static_assert(Pid{} == Pid{.integral = 0.0F,
                           .derivative = 0.0F,
                           .reference = 0.0F,
                           .measured = 0.0F,
                           .output = 0.0F,
                           .started = false,
                           .rejected = 0});

static_assert(near(control_angle({}, radians(-175.0F), radians(175.0F), 0.1F, wide(1.0F, 0.0F, 0.0F)).output,
                   radians(10.0F)));

constexpr float turning() {
  // From 175 to -175 degrees in 0.1 s is +100 degrees/s, not -3500.
  const PidModel model = wide(0.0F, 0.0F, 1.0F);
  const Pid before = control_angle({}, 0.0F, radians(175.0F), 0.1F, model);
  return control_angle(before, 0.0F, radians(-175.0F), 0.1F, model).output;
}
static_assert(near(turning(), -radians(100.0F), 1e-4F));

constexpr float following() {
  // The same of a reference that moves, where the error is derived.
  PidModel model = wide(0.0F, 0.0F, 1.0F);
  model.derivative_of_reference = 1.0F;
  const Pid before = control_angle({}, radians(175.0F), 0.0F, 0.1F, model);
  return control_angle(before, radians(-175.0F), 0.0F, 0.1F, model).output;
}
static_assert(near(following(), radians(100.0F), 1e-4F));

constexpr bool refused(float reference, float measured, float dt_s) {
  const PidModel model = wide(3.0F, 0.5F, 1.0F);
  Pid expected = first;
  expected.rejected = 1;
  return control(first, reference, measured, dt_s, model) == expected &&
         control_angle(first, reference, measured, dt_s, model) == expected;
}
static_assert(refused(nan, 3.0F, 0.1F) && refused(5.0F, nan, 0.1F) && refused(5.0F, 3.0F, nan));
static_assert(refused(infinity, 3.0F, 0.1F) && refused(5.0F, 3.0F, 0.0F) && refused(5.0F, 3.0F, -0.1F));

PidModel bounded(float tracking_s) {
  return {.kp = 1.0F, .ki = 2.0F, .least = -1.0F, .most = 1.0F, .tracking_s = tracking_s};
}

TEST_CASE("a number that gets lost inside the step is refused, too", "[motion]") {
  CHECK(control({}, 3e38F, -3e38F, 0.1F, wide(3.0F, 0.0F, 0.0F)) == Pid{.rejected = 1});
  const Pid after = control(first, 3e38F, -3e38F, 0.1F, wide(3.0F, 0.5F, 0.0F));
  CHECK(after.rejected == 1);
  CHECK(after.output == first.output);
}

TEST_CASE("the integral does not wind up while the motor gives all it has", "[motion]") {
  for (const float tracking_s : {0.0F, 0.2F}) {
    CAPTURE(tracking_s);
    Pid pid{};
    for (int i = 0; i < 1000; ++i) pid = control(pid, 10.0F, 0.0F, 0.03F, bounded(tracking_s));
    CHECK(pid.output == 1.0F);
    CHECK(pid.integral <= 0.0F);  // P alone is more than enough
    // The set point is passed: the output turns at once, and does not wait for 30 s of integral.
    int steps = 0;
    while (pid.output > 0.0F && steps < 1000) {
      pid = control(pid, 10.0F, 10.5F, 0.03F, bounded(tracking_s));
      ++steps;
    }
    CHECK(steps <= 20);
  }
}

TEST_CASE("back-calculation takes the integral down while the output is at its bound", "[motion]") {
  Pid pid{};
  pid.integral = 1.0F;
  // I = 1 + 2 * 1 * 0.03 = 1.06, u = 1 + 1.06 = 2.06, bounded 1: I = 1.06 - 1.06 * 0.03 / 0.2 = 0.901
  pid = control(pid, 1.0F, 0.0F, 0.03F, bounded(0.2F));
  CHECK(near(pid.integral, 0.901F));
  CHECK(pid.output == 1.0F);
  // A step longer than 0.2 s takes all that is beyond, and no more: I = 1 + 2 * 1 * 0.5 = 2, u = 3.
  const Pid late = control({.integral = 1.0F}, 1.0F, 0.0F, 0.5F, bounded(0.2F));
  CHECK(near(late.integral, 0.0F));
}

TEST_CASE("clamping lets the integral go back from the bound", "[motion]") {
  Pid pid{};
  pid.integral = 1.0F;
  pid = control(pid, 0.5F, 0.0F, 0.1F, bounded(0.0F));
  CHECK(pid.integral == 1.0F);  // would go to 1.1
  pid = control(pid, -0.5F, 0.0F, 0.1F, bounded(0.0F));
  CHECK(near(pid.integral, 0.9F));
}

TEST_CASE("the integral takes what room the rest leaves to the bound, and never gives back", "[motion]") {
  struct Row {
    float integral, error, integral_after;
  };
  // kp = 1, ki = 100 over 0.1 s: ten times the error is asked for. Of 1 the error itself and I are taken.
  const Row rows[] = {{0.5F, 0.25F, 0.75F},   {-0.5F, -0.25F, -0.75F}, {-0.5F, 0.25F, 0.75F},
                      {0.5F, -0.25F, -0.75F}, {0.25F, 2.0F, 0.25F},    {-0.25F, -2.0F, -0.25F},
                      {0.5F, -2.0F, 0.5F},    {-0.5F, 2.0F, -0.5F}};
  const PidModel eager{.kp = 1.0F, .ki = 100.0F};
  for (const Row& row : rows) {
    CAPTURE(row.integral, row.error);
    CHECK(
        near(control({.integral = row.integral}, row.error, 0.0F, 0.1F, eager).integral, row.integral_after));
  }
}

TEST_CASE("whatever comes, output and integral stay within the bounds", "[motion]") {
  Random random{6};
  const float odd[] = {nan, infinity, -infinity, 3e38F, -3e38F, 1e-40F};
  for (int round = 0; round < 200; ++round) {
    const auto number = [&] { return static_cast<float>(random.within(-1000, 1000)) / 100.0F; };
    const auto any = [&] { return random.below(10) == 0 ? odd[random.below(6)] : number(); };
    const PidModel model{.kp = number(),
                         .ki = number(),
                         .kd = number(),
                         .derivative_filter_s = static_cast<float>(random.below(3)) * 0.05F,
                         .derivative_of_reference = static_cast<float>(random.below(2)),
                         .tracking_s = static_cast<float>(random.below(3)) * 0.1F};
    Pid pid{};
    for (int i = 0; i < 200; ++i) {
      pid = random.below(2) == 0 ? control(pid, any(), any(), 0.03F, model)
                                 : control_angle(pid, any(), any(), 0.03F, model);
      CAPTURE(round, i, pid.output, pid.integral);
      REQUIRE((pid.output >= -1.0F && pid.output <= 1.0F));
      REQUIRE((pid.integral >= -1.0F && pid.integral <= 1.0F));
      REQUIRE(is_finite(pid.derivative));
    }
    REQUIRE(pid.rejected > 0);
  }
}

TEST_CASE("a PI controller leaves no error behind", "[motion]") {
  // Plant: dy/dt = (u - y - 0.3) / 0.2: a load of 0.3 that P alone cannot hold against.
  Pid pid{};
  float y = 0.0F;
  for (int i = 0; i < 3000; ++i) {
    pid = control(pid, 0.5F, y, 0.01F, bounded(0.0F));
    y += (pid.output - y - 0.3F) / 0.2F * 0.01F;
  }
  CHECK(near(y, 0.5F, 1e-4F));
  CHECK(near(pid.integral, 0.8F, 1e-3F));
}

}  // namespace motion_pid_test
