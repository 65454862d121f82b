#include "ocm/mapper/app/motors.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <catch2/catch.hpp>

#include "ocm/mapper/app/models.hpp"

#include "unit/motion/near.hpp"

namespace mapper_app_motors_test {

using namespace ocm;
using mapper::app::MotorKind;
using mapper::app::MotorModel;
using mapper::app::Motors;
using mapper::app::WheelTicks;
using motion::Efforts;
using motion::Movement;
using motion::PoseCommand;
using ocm::test::near;

constexpr float dt = 0.020F;
constexpr MotorModel gated = mapper::app::avr_robot.motors;
constexpr MotorModel paced = mapper::app::arduino_robot.motors;

constexpr PoseCommand ahead(float effort) {
  return {Movement::straight, effort, 0.0F, false};
}
constexpr PoseCommand left_turn(float effort) {
  return {Movement::rotating, 0.0F, effort, false};
}
Efforts first(const PoseCommand& command, const MotorModel& model) {
  return move({}, command, {}, dt, model).efforts;
}

TEST_CASE("mapper motors: on and off: never less than what turns a motor", "[mapper_motors]") {
  CHECK(first(ahead(1.0F), gated) == Efforts{1.0F, 1.0F});
  CHECK(first(ahead(0.7F), gated) == Efforts{0.7F, 0.7F});
  CHECK(first(ahead(0.1F), gated) == Efforts{0.4F, 0.4F});
  CHECK(first(ahead(-0.1F), gated) == Efforts{-0.4F, -0.4F});
  CHECK(first(ahead(0.04F), gated) == Efforts{});  // would only make it twitch
  CHECK(first(left_turn(0.5F), gated) == Efforts{-0.5F, 0.5F});
  CHECK(first(left_turn(-0.5F), gated) == Efforts{0.5F, -0.5F});
  CHECK(first({Movement::standing, 1.0F, 1.0F, false}, gated) == Efforts{});
}

// [T2 eq. 7.1, u2]
TEST_CASE("mapper motors: on and off: the wheel that is a tick ahead waits", "[mapper_motors]") {
  Motors state = move({}, ahead(1.0F), {100, 200}, dt, gated).state;
  const auto at = [&state](WheelTicks ticks, const PoseCommand& command = ahead(1.0F)) {
    const auto step = move(state, command, ticks, dt, gated);
    state = step.state;
    return step.efforts;
  };
  CHECK(at({101, 200}) == Efforts{0.0F, 1.0F});
  CHECK(at({101, 201}) == Efforts{1.0F, 1.0F});
  CHECK(at({101, 202}) == Efforts{1.0F, 0.0F});
  SECTION("a new movement begins from rest") {
    CHECK(at({101, 202}, left_turn(1.0F)) == Efforts{-1.0F, 1.0F});
    CHECK(at({99, 203}, left_turn(1.0F)) == Efforts{0.0F, 1.0F});
    CHECK(at({99, 203}, left_turn(-1.0F)) == Efforts{1.0F, -1.0F});
  }
  SECTION("so does one after a stop") {
    CHECK(at({101, 202}, {}) == Efforts{});
    CHECK(at({101, 202}) == Efforts{1.0F, 1.0F});
  }
  SECTION("across the end of the counters") {
    state = move({}, ahead(-1.0F), {1, 1}, dt, gated).state;
    CHECK(at({0U - 1, 0}, ahead(-1.0F)) == Efforts{0.0F, -1.0F});
  }
}

/// Two motors of a robot with PWM, 80 ms slow, one stronger than the other.
struct Wheels {
  float left_ticks_s = 0.0F;
  float right_ticks_s = 0.0F;
  double left = 0.0;
  double right = 0.0;
  float strength = 1.0F;

  void obey(Efforts efforts) {
    const float share = dt / 0.08F;
    left_ticks_s += share * (1250.0F * strength * efforts.left - left_ticks_s);
    right_ticks_s += share * (1250.0F * efforts.right - right_ticks_s);
    left += static_cast<double>(left_ticks_s * dt);
    right += static_cast<double>(right_ticks_s * dt);
  }
  WheelTicks ticks() const {
    const auto counted = [](double t) {
      return static_cast<std::uint32_t>(static_cast<std::int64_t>(std::floor(t)));
    };
    return {counted(left), counted(right)};
  }
};
void drive(Wheels& motors, Motors& state, const PoseCommand& command, int steps) {
  for (int i = 0; i < steps; ++i) {
    const auto step = move(state, command, motors.ticks(), dt, paced);
    state = step.state;
    motors.obey(step.efforts);
  }
}

// [T2 §7.1.1]
TEST_CASE("mapper motors: a pair of unlike motors turns alike", "[mapper_motors]") {
  for (const float strength : {0.8F, 1.2F}) {
    Wheels motors{.strength = strength};
    Motors state;
    drive(motors, state, ahead(0.5F), 200);
    CHECK(near(motors.right_ticks_s, 625.0F, 30.0F));
    CHECK(near(motors.left_ticks_s, motors.right_ticks_s, 30.0F));
    drive(motors, state, ahead(-0.5F), 200);
    CHECK(near(motors.right_ticks_s, -625.0F, 30.0F));
    CHECK(near(motors.left_ticks_s, motors.right_ticks_s, 30.0F));
    drive(motors, state, left_turn(0.4F), 200);
    CHECK(near(motors.right_ticks_s, 500.0F, 30.0F));
    CHECK(near(motors.left_ticks_s, -500.0F, 30.0F));
  }
}

TEST_CASE("mapper motors: a pair keeps the curve that is asked for", "[mapper_motors]") {
  Wheels motors;
  Motors state;
  drive(motors, state, {Movement::straight, 0.5F, 0.1F, false}, 300);
  CHECK(near(motors.right_ticks_s, 750.0F, 30.0F));
  CHECK(near(motors.left_ticks_s, 500.0F, 30.0F));
}

// What a wheel's integral still gives is never against the way that it came.
TEST_CASE("mapper motors: a wheel that is to stand while the other turns runs out forwards",
          "[mapper_motors]") {
  Wheels motors;
  Motors state;
  drive(motors, state, ahead(0.5F), 200);
  const PoseCommand about_left{Movement::straight, 0.25F, 0.25F, false};
  bool runs_out = false;
  for (int i = 0; i < 50; ++i) {
    const auto step = move(state, about_left, motors.ticks(), dt, paced);
    CHECK(step.efforts.left >= 0.0F);
    runs_out |= step.efforts.left > 0.0F;
    state = step.state;
    motors.obey(step.efforts);
  }
  CHECK(runs_out);
  CHECK(near(motors.left_ticks_s, 0.0F, 30.0F));
  CHECK(near(motors.right_ticks_s, 625.0F, 30.0F));
}

TEST_CASE("mapper motors: told to stand, a pair is off at once", "[mapper_motors]") {
  Wheels motors;
  Motors state;
  drive(motors, state, ahead(1.0F), 50);
  CHECK(move(state, {}, motors.ticks(), dt, paced).efforts == Efforts{});
  CHECK(move(state, ahead(0.01F), motors.ticks(), dt, paced).efforts == Efforts{});
  CHECK(move(state, ahead(1.0F), motors.ticks(), 0.0F, paced).efforts == Efforts{});  // no time has passed
}

TEST_CASE("mapper motors: what is no number turns no motor", "[mapper_motors]") {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  constexpr float inf = std::numeric_limits<float>::infinity();
  for (const MotorKind kind : {MotorKind::gated, MotorKind::paced, MotorKind::direct}) {
    MotorModel model = paced;
    model.kind = kind;
    for (const PoseCommand& command :
         {ahead(nan), ahead(inf), left_turn(nan), PoseCommand{Movement::straight, 1.0F, inf, false}})
      CHECK(first(command, model) == Efforts{});
  }
}

TEST_CASE("mapper motors: efforts are never beyond 1, whatever comes", "[mapper_motors]") {
  std::mt19937 random{11};
  std::uniform_real_distribution<float> any{-3.0F, 3.0F};
  for (const MotorKind kind : {MotorKind::gated, MotorKind::paced, MotorKind::direct}) {
    MotorModel model = paced;
    model.kind = kind;
    Motors state;
    for (int i = 0; i < 20'000; ++i) {
      const auto movement = static_cast<Movement>(random() % 3);
      const auto step =
          move(state, {movement, any(random), any(random), false},
               {static_cast<std::uint32_t>(random() % 1000), static_cast<std::uint32_t>(random())},
               0.001F * static_cast<float>(random() % 100), model);
      state = step.state;
      REQUIRE(std::fabs(step.efforts.left) <= 1.0F);
      REQUIRE(std::fabs(step.efforts.right) <= 1.0F);
      if (movement == Movement::standing) REQUIRE(step.efforts == Efforts{});
    }
  }
}

}  // namespace mapper_app_motors_test
