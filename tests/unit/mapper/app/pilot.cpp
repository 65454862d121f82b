#include "ocm/mapper/app/pilot.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/motion/odometry.hpp"

#include "unit/motion/near.hpp"

namespace mapper_app_pilot_test {

using namespace ocm;
using mapper::app::Pilot;
using mapper::app::PilotEnd;
using motion::Pose;
using ocm::test::near;

constexpr float dt = 0.030F;
constexpr const motion::PoseControllerModel& model = mapper::app::arduino_robot.controller;

/// 0.3 m/s and 2 rad/s at full effort, at once.
void obey(Pose& pose, const motion::PoseCommand& command) {
  pose = motion::moved(pose, {0.3F * command.ahead * dt, 2.0F * command.turn * dt});
}
PilotEnd drive(Pilot& pilot, Pose& pose, motion::SetPoint set_point) {
  pilot.begin(set_point, pose);
  for (int i = 0; i < 2000; ++i) {
    const auto step = pilot.go(pose, dt);
    obey(pose, step.command);
    if (step.end != PilotEnd::none) return step.end;
  }
  return PilotEnd::none;
}

TEST_CASE("mapper pilot: arrives once, and then has nothing to do", "[mapper_pilot]") {
  Pilot pilot{model};
  Pose pose;
  CHECK_FALSE(pilot.driving());
  CHECK(drive(pilot, pose, motion::set_point(90, 50)) == PilotEnd::arrived);
  CHECK(near(pose.x_m, 0.0F, 0.03F));
  CHECK(near(pose.y_m, 0.5F, 0.03F));
  CHECK_FALSE(pilot.driving());
  const auto after = pilot.go(pose, dt);
  CHECK(after.end == PilotEnd::none);
  CHECK(motion::efforts(after.command) == motion::Efforts{});
}

TEST_CASE("mapper pilot: home by the places that it left, forwards, the last one first", "[mapper_pilot]") {
  Pilot pilot{model};
  Pose pose;
  drive(pilot, pose, motion::set_point(0, 60));
  drive(pilot, pose, motion::set_point(90, 80));
  drive(pilot, pose, motion::set_point(-45, -30));  // backwards
  CHECK(pilot.history().size() == 3);
  std::vector<Pose> way;
  int steps = 0;
  bool backwards = false;
  for (; steps < 10'000; ++steps) {
    const auto step = pilot.go_home(pose, dt);
    backwards =
        backwards || (step.command.movement == motion::Movement::straight && step.command.ahead < -0.3F);
    obey(pose, step.command);
    way.push_back(pose);
    if (step.end == PilotEnd::home) break;
  }
  CHECK(steps < 10'000);
  CHECK_FALSE(backwards);
  CHECK(near(pose.x_m, 0.0F, 0.05F));
  CHECK(near(pose.y_m, 0.0F, 0.05F));
  // Past the corner, and not across.
  float corner = 1e9F;
  for (const Pose& at : way) corner = std::min(corner, std::hypot(at.x_m - 0.6F, at.y_m));
  CHECK(corner < 0.05F);
  CHECK(pilot.go_home(pose, dt).end == PilotEnd::home);
}

TEST_CASE("mapper pilot: home from the middle of a drive", "[mapper_pilot]") {
  Pilot pilot{model};
  Pose pose;
  drive(pilot, pose, motion::set_point(0, 60));
  pilot.begin(motion::set_point(90, 80), pose);
  for (int i = 0; i < 130; ++i) obey(pose, pilot.go(pose, dt).command);
  CHECK(pose.y_m > 0.2F);
  pilot.stop();
  int steps = 0;
  while (pilot.go_home(pose, dt).end != PilotEnd::home && ++steps < 5000)
    obey(pose, pilot.go(pose, dt).command);
  CHECK(steps < 5000);
  CHECK(std::hypot(pose.x_m, pose.y_m) < 0.06F);
}

TEST_CASE("mapper pilot: what was forgotten is not driven to", "[mapper_pilot]") {
  Pilot pilot{model};
  Pose pose;
  drive(pilot, pose, motion::set_point(0, 60));
  pilot.forget();
  CHECK(pilot.go_home(pose, dt).end == PilotEnd::home);
}

TEST_CASE("mapper pilot: stopped, it stays", "[mapper_pilot]") {
  Pilot pilot{model};
  Pose pose;
  pilot.begin(motion::set_point(0, 100), pose);
  for (int i = 0; i < 10; ++i) obey(pose, pilot.go(pose, dt).command);
  pilot.stop();
  CHECK_FALSE(pilot.driving());
  CHECK(motion::efforts(pilot.go(pose, dt).command) == motion::Efforts{});
}

TEST_CASE("mapper pilot: a robot that knows not where it is gets home at once, standing", "[mapper_pilot]") {
  Pilot pilot{model};
  Pose pose;
  drive(pilot, pose, motion::set_point(0, 60));
  drive(pilot, pose, motion::set_point(90, 60));
  const Pose lost{std::numeric_limits<float>::quiet_NaN(), 0, 0};
  int steps = 0;
  while (pilot.go_home(lost, dt).end != PilotEnd::home && ++steps < 10)
    CHECK(motion::efforts(pilot.go(lost, dt).command) == motion::Efforts{});
  CHECK(steps < 10);
  CHECK(pilot.rejected() > 0);
}

}  // namespace mapper_app_pilot_test
