#include "ocm/motion/pose_controller.hpp"

#include <cmath>
#include <cstdint>
#include <limits>

#include <catch2/catch.hpp>

#include "ocm/motion/odometry.hpp"
#include "ocm/motion/pose_estimator.hpp"

#include "unit/motion/near.hpp"

namespace motion_pose_controller_test {

using namespace ocm::motion;
using ocm::test::near;
using ocm::test::near_angle;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float dt = 0.030F;

static_assert(near(set_point(90, 130).turn_rad, pi / 2.0F) && near(set_point(90, 130).distance_m, 1.3F));
static_assert(near(set_point(-90, -5).turn_rad, -pi / 2.0F) && near(set_point(-90, -5).distance_m, -0.05F));
static_assert(near(set_point(270, 0).turn_rad, -pi / 2.0F, 1e-6F), "the short way round");
static_assert(set_point(180, 0).turn_rad == pi && set_point(720, 0).turn_rad == 0.0F);
static_assert(near(set_point(INT32_MAX, 0).turn_rad, radians(INT32_MAX % 360), 1e-5F));

constexpr PoseControllerModel model{
    .heading =
        {.kp = 2.0F, .ki = 0.2F, .kd = 0.05F, .derivative_filter_s = 0.05F, .derivative_of_reference = 1.0F},
    .distance =
        {.kp = 5.0F, .ki = 0.2F, .kd = 0.1F, .derivative_filter_s = 0.05F, .derivative_of_reference = 1.0F},
    .heading_reference = {.gain = 0.1F, .period_s = dt},
    .distance_reference = {.gain = 0.1F, .period_s = dt}};

/// A robot of 0.3 m/s and 2 rad/s at full effort, whose motors take 50 ms.
struct Robot {
  Pose pose{};
  Twist twist{};

  void step(const PoseCommand& command, float dt_s) {
    const Efforts wheels = efforts(command);
    const float share = dt_s / (0.05F + dt_s);
    twist.speed_m_s += share * (0.3F * (wheels.right + wheels.left) / 2.0F - twist.speed_m_s);
    twist.turn_rad_s += share * (2.0F * (wheels.right - wheels.left) / 2.0F - twist.turn_rad_s);
    pose = moved(pose, {twist.speed_m_s * dt_s, twist.turn_rad_s * dt_s});
  }
};

/// Steps until it has arrived; how many that took, 0: never.
int drive(Robot& robot, PoseController& state, SetPoint target) {
  state = started(state, target, robot.pose);
  for (int i = 1; i < 3000; ++i) {
    const float dt_s = i % 7 == 0 ? 0.045F : dt;  // a step that comes late
    const PoseControllerStep step = control(state, robot.pose, dt_s, model);
    state = step.state;
    robot.step(step.command, dt_s);
    if (step.command.arrived) return i;
  }
  return 0;
}

TEST_CASE("the square of table 13.1", "[motion]") {
  // By hand: each command from the ideal end of the one before, x, y in cm, heading in degrees. The camera
  // saw (57.9,-0.4,0) (64.3,123.4,89.7) (-50.8,132.3,181.4) (-61.7,8.4,272.5) (-15.8,-2.2,351) of the real
  // robot.
  struct Leg {
    int degrees, cm;
    Pose ideal, camera;
  };
  const auto cm = [](float x, float y, float degrees) {
    return Pose{x / 100, y / 100, wrap(radians(degrees))};
  };
  const Leg legs[] = {{0, 60, cm(60, 0, 0), cm(57.9F, -0.4F, 0)},
                      {90, 130, cm(60, 130, 90), cm(64.3F, 123.4F, 89.7F)},
                      {90, 120, cm(-60, 130, 180), cm(-50.8F, 132.3F, 181.4F)},
                      {90, 130, cm(-60, 0, 270), cm(-61.7F, 8.4F, 272.5F)},
                      {85, 52, cm(-8.198F, -4.532F, 355), cm(-15.8F, -2.2F, 351)}};
  Robot robot;
  PoseController state;
  for (const Leg& leg : legs) {
    const int steps = drive(robot, state, set_point(leg.degrees, leg.cm));
    CAPTURE(leg.degrees, leg.cm, steps, robot.pose.x_m, robot.pose.y_m, degrees(robot.pose.heading_rad));
    REQUIRE(steps > 0);
    CHECK(near(robot.pose, leg.ideal, 0.05F, radians(4.0F)));
    CHECK(near(robot.pose, leg.camera, 0.12F, radians(6.0F)));
    CHECK(state.phase == PoseController::Phase::idle);
  }
}

/// The AVR robot as its estimator meets it: 198 ticks a turn, 66 a second at most; turning on the spot its
/// wheels slip and show 1/10 too much, and its gyro shows 1/30 too little. [T2 §7.3, §11.2.3]
struct SlippingRobot {
  static constexpr Drive drive{.wheel_radius_m = 0.033F, .wheelbase_m = 0.15F, .ticks_per_turn = 198.0F};
  Pose pose{};
  double left = 0.0;  // ticks
  double right = 0.0;

  EstimatorReadings step(const PoseCommand& command, float dt_s) {
    const Efforts wheels = efforts(command);
    const float slip = command.movement == Movement::rotating ? 1.1F : 1.0F;
    const float left_ticks = 66.0F * wheels.left * dt_s;
    const float right_ticks = 66.0F * wheels.right * dt_s;
    left += static_cast<double>(left_ticks);
    right += static_cast<double>(right_ticks);
    const float turn = (right_ticks - left_ticks) * drive.m_per_tick() / drive.wheelbase_m / slip;
    pose = moved(pose, {(left_ticks + right_ticks) / 2.0F * drive.m_per_tick(), turn});
    const auto counted = [](double ticks) {
      return static_cast<std::uint32_t>(std::int64_t(std::floor(ticks)));
    };
    return {counted(left), counted(right), 29.0F / 30.0F * turn / dt_s, 0.0F, command.movement};
  }
};

/// After the square of table 13.1, degrees; and whether every leg ended.
float heading_error_after_square(float gyro_weight, bool& ended) {
  const EstimatorModel estimator{.drive = SlippingRobot::drive,
                                 .heading = {.gyro_weight = gyro_weight},
                                 .most_ticks = 10,
                                 .compass_variance_rad2 = 1e6F};
  SlippingRobot robot;
  PoseController state;
  Estimate known = estimate({}, {}, dt, estimator);
  const int square[][2] = {{0, 60}, {90, 130}, {90, 120}, {90, 130}, {85, 52}};
  ended = true;
  for (const auto& leg : square) {
    state = started(state, set_point(leg[0], leg[1]), known.pose);
    bool arrived = false;
    for (int i = 0; i < 5000 && !arrived; ++i) {
      const PoseControllerStep step = control(state, known.pose, dt, model);
      state = step.state;
      known = estimate(known, robot.step(step.command, dt), dt, estimator);
      arrived = step.command.arrived;
    }
    ended = ended && arrived;
  }
  CHECK(known.wheels.rejected == 0);
  return std::fabs(degrees(difference(robot.pose.heading_rad, radians(355.0F))));
}

TEST_CASE("estimator and controller together: the blend holds the square, its parts do not", "[motion]") {
  bool ended = false;
  CHECK(heading_error_after_square(0.75F, ended) < 6.0F);
  CHECK(ended);
  CHECK(heading_error_after_square(0.0F, ended) > 20.0F);  // wheels alone: 355 degrees less a tenth
  CHECK(heading_error_after_square(1.0F, ended) > 8.0F);   // gyro alone: and a thirtieth more
}

TEST_CASE("a single leg ends within the tolerances, forwards and backwards", "[motion]") {
  for (const int cm : {60, -60, 3}) {
    Robot robot{.pose = {1.0F, -2.0F, radians(170.0F)}};
    PoseController state;
    CAPTURE(cm);
    REQUIRE(drive(robot, state, set_point(30, cm)) > 0);
    const float d = static_cast<float>(cm) / 100.0F;
    const float heading = radians(200.0F);
    // Small tolerances across, as the turn is one degree off at most.
    CHECK(near(robot.pose, {1.0F + d * std::cos(heading), -2.0F + d * std::sin(heading), wrap(heading)},
               0.025F, radians(1.5F)));
  }
}

TEST_CASE("half a turn does not hesitate at the edge of the range", "[motion]") {
  for (const float from : {0.0F, 1.0F, 3.1F, -3.1F, -1.0F}) {
    Robot robot{.pose = {0.0F, 0.0F, from}};
    PoseController state;
    CHECK(drive(robot, state, set_point(180, 0)) > 0);
    CHECK(near_angle(robot.pose.heading_rad, from + pi, radians(1.5F)));
  }
}

TEST_CASE("{U,0,0} stops at once and has arrived", "[motion]") {
  Robot robot;
  PoseController state = started({}, set_point(0, 100), robot.pose);
  for (int i = 0; i < 20; ++i) {
    const auto step = control(state, robot.pose, dt, model);
    state = step.state;
    robot.step(step.command, dt);
  }
  CHECK(robot.twist.speed_m_s > 0.05F);
  const auto step = control(started(state, set_point(0, 0), robot.pose), robot.pose, dt, model);
  CHECK(step.command.arrived);
  CHECK(step.command.movement == Movement::standing);
  CHECK(efforts(step.command) == Efforts{});
  const auto after = control(step.state, robot.pose, dt, model);
  CHECK_FALSE(after.command.arrived);  // told once
  CHECK(efforts(after.command) == Efforts{});
}

TEST_CASE("a new set point starts from the present pose", "[motion]") {
  const Pose present{1.0F, 2.0F, 0.5F};
  PoseController state = started({}, set_point(90, 0), {});
  for (int i = 0; i < 20; ++i) state = control(state, {}, dt, model).state;
  CHECK(state.turn_reference_rad > 0.5F);
  CHECK(state.heading.integral > 0.0F);
  state = started(state, set_point(0, 50), present);
  CHECK(state.start == present);
  CHECK(state.turn_reference_rad == 0.0F);
  CHECK(state.heading == Pid{});
  CHECK(state.phase == PoseController::Phase::driving);  // nothing to turn
  // The model takes a tenth of the way in the first step: 5 cm, so an effort of 5 * 0.05.
  const auto step = control(state, present, dt, model);
  CHECK(near(step.state.distance_reference_m, 0.05F));
  CHECK(near(step.command.ahead, 0.25F, 1e-3F));
  CHECK(near(step.command.turn, 0.0F));
}

TEST_CASE("a robot that slid while it turned still drives the whole distance", "[motion]") {
  PoseController state = started({}, set_point(90, 60), {});
  const Pose slid{0.1F, 0.05F, pi / 2.0F};
  for (int i = 0; i < 100 && state.phase == PoseController::Phase::turning; ++i) {
    state = control(state, slid, dt, model).state;
  }
  REQUIRE(state.phase == PoseController::Phase::driving);
  CHECK(state.start == Pose{0.1F, 0.05F, 0.0F});
}

TEST_CASE("turning is no straight drive, and turning alone never becomes one", "[motion]") {
  Robot robot;
  PoseController state = started({}, set_point(45, 0), robot.pose);
  bool arrived = false;
  for (int i = 0; i < 500 && !arrived; ++i) {
    const auto step = control(state, robot.pose, dt, model);
    CHECK(step.command.movement == (step.command.arrived ? Movement::standing : Movement::rotating));
    state = step.state;
    robot.step(step.command, dt);
    arrived = step.command.arrived;
  }
  CHECK(arrived);
}

/// How many steps a robot that does not move takes to arrive; 0: more than ten.
int steps_to_arrive(SetPoint target, const PoseControllerModel& with, const Pose& disturbed = {}) {
  PoseController state = started({}, target, {});
  for (int i = 1; i <= 10; ++i) {
    const PoseControllerStep step = control(state, i == 2 ? disturbed : Pose{}, dt, with);
    if (step.command.arrived) return i;
    state = step.state;
  }
  return 0;
}

TEST_CASE("it has arrived after three steps within tolerance, one after the other", "[motion]") {
  PoseControllerModel jumping{};  // whose reference is at the set point at once
  jumping.heading_reference.gain = 1.0F;
  jumping.distance_reference.gain = 1.0F;
  const float turn_rad = radians(0.9F);
  CHECK(steps_to_arrive({turn_rad, 0.0F}, jumping) == 3);
  CHECK(steps_to_arrive({0.0F, 0.009F}, jumping) == 3);
  CHECK(steps_to_arrive({turn_rad, 0.009F}, jumping) == 5);  // the third is the first of the way
  CHECK(steps_to_arrive({turn_rad, 0.0F}, jumping, {0.0F, 0.0F, -0.1F}) == 5);  // it starts again
  CHECK(steps_to_arrive({0.0F, 0.009F}, jumping, {-0.1F, 0.0F, 0.0F}) == 5);
  CHECK(steps_to_arrive({radians(1.1F), 0.0F}, jumping) == 0);
  CHECK(steps_to_arrive({0.0F, 0.011F}, jumping) == 0);
  CHECK(steps_to_arrive({0.0F, -0.011F}, jumping) == 0);

  // What is at its tolerance is within it: the robot, and the reference that has not moved.
  PoseControllerModel exact{};
  exact.heading_tolerance_rad = 0.25F;
  exact.distance_tolerance_m = 0.25F;
  exact.settled_steps = 1;
  exact.heading_reference.gain = 0.0F;
  exact.distance_reference.gain = 0.0F;
  for (const float at : {0.25F, -0.25F}) {
    CHECK(steps_to_arrive({at, 0.0F}, exact) == 1);
    CHECK(steps_to_arrive({0.0F, at}, exact) == 1);
    CHECK(steps_to_arrive({1.125F * at, 0.0F}, exact) == 0);
    CHECK(steps_to_arrive({0.0F, 1.125F * at}, exact) == 0);
  }
}

TEST_CASE("with no numbers of its own, it asks for one effort a radian and one a metre", "[motion]") {
  PoseControllerModel plain{};
  plain.heading_reference.gain = 1.0F;
  plain.distance_reference.gain = 1.0F;
  const PoseCommand turns = control(started({}, {0.5F, 1.0F}, {}), {}, dt, plain).command;
  CHECK(near(turns.turn, 0.5F));
  CHECK(turns.ahead == 0.0F);
  const PoseCommand drives = control(started({}, {0.0F, -0.5F}, {}), {}, dt, plain).command;
  CHECK(near(drives.ahead, -0.5F));
  CHECK(drives.turn == 0.0F);
  CHECK(drives.movement == Movement::straight);
}

TEST_CASE("what the turn needed to get there is not carried into the way", "[motion]") {
  PoseController state = started({}, set_point(90, 60), {});
  for (int i = 0; i < 200; ++i) {
    const float heading_rad = i < 30 ? 0.0F : radians(89.5F);  // stuck at first
    const PoseControllerStep step = control(state, {0.0F, 0.0F, heading_rad}, dt, model);
    state = step.state;
    if (state.phase != PoseController::Phase::driving) continue;
    const Pid fresh = control_angle({}, pi / 2.0F, heading_rad, dt, model.heading);
    CHECK(near(state.heading.integral, fresh.integral));
    CHECK(near(state.heading.output, fresh.output));
    CHECK(state.heading.derivative == 0.0F);
    CHECK(step.command.turn == state.heading.output);
    CHECK(step.command.ahead == state.distance.output);
    CHECK(step.command.movement == Movement::straight);
    return;
  }
  REQUIRE(state.phase == PoseController::Phase::driving);  // it never drove
}

TEST_CASE("a set point counts what was rejected before it, and begins with nothing else", "[motion]") {
  PoseController state = started({}, set_point(90, 60), {});
  state = control(state, {}, nan, model).state;
  for (int i = 0; i < 10; ++i) state = control(state, {}, dt, model).state;
  const auto is_fresh = [](const PoseController& one) {
    return one.turn_reference_rad == 0.0F && one.distance_reference_m == 0.0F && one.heading == Pid{} &&
           one.distance == Pid{} && one.settled == 0;
  };
  const PoseController next = started(state, {4.0F, -1.0F}, {1.0F, 2.0F, 0.5F});
  CHECK(next.rejected == 1);
  CHECK(near(next.target.turn_rad, 4.0F - two_pi));
  CHECK(next.target.distance_m == -1.0F);
  CHECK(next.phase == PoseController::Phase::turning);
  CHECK(is_fresh(next));
  CHECK(started(next, {0.0F, nan}, {}).rejected == 2);
  CHECK(stopped(next).target == SetPoint{0.0F, 0.0F});
  CHECK(stopped(next).start == Pose{0.0F, 0.0F, 0.0F});
  CHECK(is_fresh(stopped(next)));
}

TEST_CASE("the distance is by Pythagoras, behind the start negative", "[motion]") {
  CHECK(distance_done({}, 0.0F, {0.0F, 0.5F, 0.0F}) == 0.5F);  // right beside it is not behind
  const Pose start{1.0F, 1.0F, 0.0F};
  CHECK(near(distance_done(start, 0.0F, {1.3F, 1.4F, 0.0F}), 0.5F));
  CHECK(near(distance_done(start, 0.0F, {0.7F, 1.4F, 0.0F}), -0.5F));
  CHECK(near(distance_done(start, pi, {0.7F, 1.4F, 0.0F}), 0.5F));
}

TEST_CASE("without a pose or without time the motors are off, and it is counted", "[motion]") {
  PoseController state = started({}, set_point(0, 100), {});
  for (int i = 0; i < 10; ++i) state = control(state, {}, dt, model).state;
  for (const float bad : {nan, std::numeric_limits<float>::infinity()}) {
    CHECK(efforts(control(state, {bad, 0.0F, 0.0F}, dt, model).command) == Efforts{});
    CHECK(efforts(control(state, {0.0F, bad, 0.0F}, dt, model).command) == Efforts{});
    CHECK(efforts(control(state, {0.0F, 0.0F, bad}, dt, model).command) == Efforts{});
    CHECK(efforts(control(state, {}, bad, model).command) == Efforts{});
  }
  CHECK(control(state, {}, 0.0F, model).state.rejected == 1);
  CHECK(control(control(state, {}, 0.0F, model).state, {}, dt, model).command.ahead >
        0.0F);  // and on it goes
  CHECK(started(state, {nan, 1.0F}, {}).phase == PoseController::Phase::idle);
  CHECK(started(state, {0.0F, 1.0F}, {nan, 0.0F, 0.0F}).rejected == 1);
}

TEST_CASE("a stop forgets the set point and keeps the count", "[motion]") {
  PoseController state = started({}, set_point(0, 100), {});
  state = control(state, {}, nan, model).state;
  state = stopped(state);
  CHECK(state.phase == PoseController::Phase::idle);
  CHECK(state.rejected == 1);
  CHECK(control(state, {}, dt, model).command.movement == Movement::standing);
}

}  // namespace motion_pose_controller_test
