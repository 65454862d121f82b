#include "sim/amiro/drive.hpp"

#include <cmath>

#include <catch2/catch.hpp>

#include "sim/amiro/arena.hpp"
#include "sim/physics/noise.hpp"

namespace sim_drive_test {

using namespace ocm::sim;
namespace di_wheel_drive = ocm::firmware::boards::di_wheel_drive;

const std::vector<Segment> open_space;

void run(Drive& drive, double seconds, const std::vector<Segment>& walls = open_space) {
  const long steps = std::lround(seconds / step_s);
  for (long i = 0; i < steps; ++i) drive.step(walls, true);
}

TEST_CASE("an exact arc ends where geometry says") {
  // A quarter of a circle of radius 1 m.
  const Pose quarter = arc({}, pi / 2, pi / 2);
  CHECK(quarter.x_m == Approx(1));
  CHECK(quarter.y_m == Approx(1));
  CHECK(quarter.heading_rad == Approx(pi / 2));
  // Two halves make a whole.
  const Pose halves = arc(arc({}, pi / 4, pi / 4), pi / 4, pi / 4);
  CHECK(halves.x_m == Approx(quarter.x_m));
  CHECK(halves.y_m == Approx(quarter.y_m));
  // Nearly straight joins straight.
  CHECK(arc({}, 1, 1.1e-9).x_m == Approx(arc({}, 1, 0.9e-9).x_m).epsilon(1e-6));
}

TEST_CASE("straight ahead for a second: 0.1 m, less what the lag costs") {
  Drive drive{{}, {}};
  drive.set({0.1, 0.1});
  run(drive, 1);
  const double lag_s = DriveModel{}.time_constant_s;
  // Integral of v (1 - exp(-t / lag)).
  CHECK(drive.motion().pose.x_m == Approx(0.1 * (1 - lag_s * (1 - std::exp(-1 / lag_s)))).margin(1e-4));
  CHECK(drive.motion().pose.y_m == 0);
  CHECK(drive.motion().pose.heading_rad == 0);
  CHECK(drive.wheels().left == Approx(0.1));
  CHECK_FALSE(drive.touching());

  // What the lag cost at the start comes back at the end.
  drive.set({});
  run(drive, 1);
  CHECK(drive.motion().pose.x_m == Approx(0.1).margin(1e-4));
  CHECK(drive.at_rest());
}

TEST_CASE("turning in place stays in place") {
  Drive drive{{}, {}};
  drive.set(di_wheel_drive::wheel_speeds(0, 1));
  run(drive, 2);
  drive.set({});
  run(drive, 1);
  CHECK(drive.motion().pose.heading_rad == Approx(2).margin(1e-3));
  CHECK(std::abs(drive.motion().pose.x_m) < 1e-12);
  CHECK(std::abs(drive.motion().pose.y_m) < 1e-12);
}

TEST_CASE("a circle closes, and its radius is v / w") {
  Drive drive{{}, {}};
  drive.set(di_wheel_drive::wheel_speeds(0.1, 0.5));
  run(drive, 1);  // past the lag; the radius is the same during it, as both wheels lag alike
  const Pose at = drive.motion().pose;
  run(drive, 2 * pi / 0.5);
  CHECK(drive.motion().pose.x_m == Approx(at.x_m).margin(2e-4));  // a circle takes no whole number of steps
  CHECK(drive.motion().pose.y_m == Approx(at.y_m).margin(2e-4));
  const Vector centre{0, 0.2};
  CHECK(length(drive.motion().pose.position() - centre) == Approx(0.2));
  // Centripetal acceleration v w to the left, none forwards.
  CHECK(drive.motion().acceleration_m_per_s2.y == Approx(0.1 * 0.5).epsilon(1e-3));
  CHECK(std::abs(drive.motion().acceleration_m_per_s2.x) < 1e-4);
}

TEST_CASE("wheels keep to their greatest speed and acceleration") {
  Drive drive{{}, {}};
  drive.set({50, -50});
  run(drive, 0.1);
  CHECK(drive.wheels().left == Approx(0.1 * DriveModel{}.greatest_acceleration_m_per_s2));
  run(drive, 2);
  CHECK(drive.wheels() == WheelSpeeds{1, -1});
}

TEST_CASE("without power the wheels run down") {
  Drive drive{{}, {}};
  drive.set({0.1, 0.1});
  run(drive, 1);
  for (int i = 0; i < 1000; ++i) drive.step(open_space, false);
  CHECK(drive.wheels() == WheelSpeeds{});
}

TEST_CASE("a wall stops the robot, and the wheels slip") {
  const std::vector<Segment> walls{{{0.3, -1}, {0.3, 1}}};
  for (const double speed : {0.05, 0.3, 1.0}) {
    Drive drive{{}, {}};
    drive.set({speed, speed});
    run(drive, 10, walls);
    CHECK(drive.motion().pose.x_m == Approx(0.25));
    CHECK(std::abs(drive.motion().velocity_m_per_s.x) < 1e-9);
    CHECK(drive.touching());
    CHECK(drive.ticks().left * di_wheel_drive::metres_per_tick > 0.4);

    drive.set({-speed, -speed});  // and lets it go again
    run(drive, 0.5, walls);
    CHECK(drive.motion().pose.x_m < 0.25);
    CHECK_FALSE(drive.touching());
  }
}

TEST_CASE("at a slant the robot slides along the wall") {
  const std::vector<Segment> walls{{{-5, 0.1}, {5, 0.1}}};
  Drive drive{{}, {0, 0, 30 * degree}};
  drive.set({0.2, 0.2});
  run(drive, 5, walls);
  CHECK(drive.motion().pose.y_m == Approx(0.05));
  CHECK(drive.motion().velocity_m_per_s.x == Approx(0.2 * std::cos(30 * degree)).epsilon(1e-6));
}

TEST_CASE("whatever the command, the robot stays in the arena and out of the boxes") {
  const Arena arena = default_arena();
  const Noise noise{3, 0};
  Drive drive{{}, default_start};
  double nearest = 1;
  for (unsigned i = 0; i < 400; ++i) {
    drive.set({noise.normal(i, 0), noise.normal(i, 0) + 0.2 * noise.normal(i, 1)});
    for (int k = 0; k < 100; ++k) {
      drive.step(arena.walls, true);
      const Vector place = drive.motion().pose.position();
      REQUIRE((std::abs(place.x) < 1.2 && std::abs(place.y) < 0.8));
      for (const Segment& wall : arena.walls)
        nearest = std::min(nearest, length(place - nearest_point(wall, place)));
    }
  }
  CHECK(nearest == Approx(0.05).margin(1e-6));  // it did touch, and never went in
}

TEST_CASE("encoders count 1408 ticks a turn, backwards too") {
  Drive drive{{}, {}};
  drive.set({0.175, -0.175});
  run(drive, 2);
  drive.set({});
  run(drive, 1);
  // 0.35 m of a circumference of pi * 55.71 mm.
  CHECK(drive.ticks().left == Approx(0.35 / (pi * 0.05571) * 1408).margin(2));
  CHECK(drive.ticks().right == Approx(-0.35 / (pi * 0.05571) * 1408).margin(2));
}

}  // namespace sim_drive_test
