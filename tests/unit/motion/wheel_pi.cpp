#include "ocm/motion/wheel_pi.hpp"

#include <limits>

#include <catch2/catch.hpp>

#include "unit/motion/near.hpp"

namespace motion_wheel_pi_test {

using namespace ocm::motion;
using ocm::test::near;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

constexpr WheelPiModel model{.pi = {.kp = 0.0005F, .ki = 0.004F, .least = 0.0F, .most = 1.0F},
                             .starting_effort = 0.3F};

// Master right: e = 200, u = 0.1 + 0.004 * 200 * 0.02 = 0.116; the slave follows what the master makes: e =
// 100.
constexpr WheelPiStep step = control({}, 800.0F, {500.0F, 600.0F}, 0.02F, model);
static_assert(near(step.efforts.right, 0.116F) && near(step.efforts.left, 0.058F));

constexpr WheelPiModel left_master() {
  WheelPiModel other = model;
  other.right_is_master = false;
  return other;
}
static_assert(near(control({}, 800.0F, {600.0F, 500.0F}, 0.02F, left_master()).efforts.left, 0.116F));
static_assert(near(control({}, 800.0F, {600.0F, 500.0F}, 0.02F, left_master()).efforts.right, 0.058F));

static_assert(control({}, 100.0F, {0.0F, 0.0F}, 0.02F, model).efforts == Efforts{0.0F, 0.3F},
              "the master gets what starts it; the slave follows when the master turns");
static_assert(control(step.state, 0.0F, {500.0F, 600.0F}, 0.02F, model).efforts == Efforts{});
static_assert(control(step.state, nan, {500.0F, 600.0F}, 0.02F, model).state == WheelPi{},
              "no integral is left");
static_assert(control(step.state, -1.0F, {500.0F, 600.0F}, 0.02F, model).efforts == Efforts{});

// What is not given: nothing that starts it, an effort from 0 to 1, the right wheel is the master.
constexpr WheelPiModel plain{.pi = {.kp = 0.001F}};
static_assert(near(control({}, 100.0F, {0.0F, 0.0F}, 0.02F, plain).efforts.right, 0.1F));
static_assert(near(control({}, 100.0F, {50.0F, 80.0F}, 0.02F, plain).efforts.left, 0.03F));
static_assert(control(WheelPi{}, 100.0F, WheelRates{}, 0.02F, WheelPiModel{}).efforts == Efforts{0.0F, 0.0F});

static_assert(WheelRates{}.left_ticks_s == 0.0F && WheelRates{}.right_ticks_s == 0.0F);
static_assert(WheelPiModel{}.pi.least == 0.0F && WheelPiModel{}.pi.most == 1.0F,
              "the direction is the motor's");
// A slave that is geared to turn half as fast as its master, which makes 80.
constexpr WheelPiModel geared{.pi = {.kp = 0.001F}, .slave_per_master = 0.5F};
static_assert(near(control({}, 100.0F, {30.0F, 80.0F}, 0.02F, geared).efforts.left, 0.01F));

// However slow, a wheel that turns is not started, and a rate that is asked for is one.
static_assert(near(control({}, 100.0F, {0.0F, 0.5F}, 0.02F, model).efforts.right,
                   99.5F * (0.0005F + 0.00008F)));
static_assert(near(control({}, 0.5F, {0.0F, 0.0F}, 0.02F, plain).efforts.right, 0.0005F, 1e-7F));
static_assert(control({}, 0.5F, {0.0F, 0.0F}, 0.02F, model).efforts.right == 0.3F,
              "a wheel that stands is started, however slow it should be");
static_assert(control({}, 0.5F, {0.0F, 0.0F}, 0.02F, left_master()).efforts == Efforts{0.3F, 0.0F});

/// A motor whose rate follows its effort, above what friction takes: weaker on one side.
float motor(float rate, float effort, float strength) {
  const float wanted = effort > 0.25F || rate > 0.0F ? strength * effort : 0.0F;
  return rate + (wanted - rate) * 0.2F;
}

TEST_CASE("a rate that is not finite is counted, and the last effort stands", "[motion]") {
  const WheelPiStep after = control(step.state, 800.0F, {500.0F, nan}, 0.02F, model);
  CHECK(after.state.right.rejected == 1);
  CHECK(after.state.left.rejected == 1);  // the slave does not know its master's rate
  CHECK(after.state.right.output == step.state.right.output);
  // At the end of the way nothing is left of it but the count.
  const WheelPiStep off = control(after.state, 0.0F, {500.0F, 600.0F}, 0.02F, model);
  CHECK(off.state == WheelPi{.left = {.rejected = 1}, .right = {.rejected = 1}});
}

TEST_CASE("two motors that differ turn alike, and the slave slows down with its master", "[motion]") {
  WheelPi state{};
  WheelRates rates{};
  const auto run = [&](float right_strength) {
    for (int i = 0; i < 1000; ++i) {
      const WheelPiStep next = control(state, 500.0F, rates, 0.02F, model);
      state = next.state;
      rates.left_ticks_s = motor(rates.left_ticks_s, next.efforts.left, 1250.0F);
      rates.right_ticks_s = motor(rates.right_ticks_s, next.efforts.right, right_strength);
    }
  };
  run(900.0F);
  CHECK(near(rates.right_ticks_s, 500.0F, 2.0F));
  CHECK(near(rates.left_ticks_s, 500.0F, 2.0F));
  run(400.0F);  // the master under load cannot make 500 any more
  CHECK(near(rates.right_ticks_s, 400.0F, 2.0F));
  CHECK(near(rates.left_ticks_s, 400.0F, 2.0F));
}

}  // namespace motion_wheel_pi_test
