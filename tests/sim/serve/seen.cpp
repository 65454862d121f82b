#include "sim/serve/seen.hpp"

#include <chrono>
#include <cmath>
#include <cstddef>
#include <vector>

#include <catch2/catch.hpp>

#include "sim/mapper/parts.hpp"
#include "sim/serve/shell.hpp"
#include "sim/worlds/reader.hpp"

namespace sim_serve_seen_test {

using namespace ocm;
using namespace std::chrono_literals;
using sim::Beam;
using sim::SeenRobot;
using sim::SeenWorld;

double length_of(const Beam& beam) {
  return sim::length(beam.to - beam.from);
}

TEST_CASE("what is seen of the AMiRo is what its world has") {
  sim::WorldOptions options;
  options.start = {1.05, 0, 0};  // the wall is 0.15 m ahead
  options.state_of_charge = 0.5;
  sim::World world{options};
  world.set_light(2, {1, 2, 3});
  const SeenWorld seen = sim::seen(world, "AMiRo");
  CHECK(seen.name == "AMiRo");
  CHECK(seen.time == world.time());
  CHECK(seen.walls.size() == options.arena.walls.size());
  REQUIRE(seen.robots.size() == 1);
  const SeenRobot& robot = seen.robots[0];
  CHECK(robot.pose == world.pose());
  CHECK(robot.centre == world.pose().position());
  CHECK(robot.radius_m == Approx(0.05));
  CHECK(*robot.charge == Approx(0.5).margin(0.01));
  REQUIRE(robot.lights.size() == 8);
  CHECK(robot.lights[2] == firmware::boards::Colour{1, 2, 3});
  CHECK_FALSE(robot.touching);
  REQUIRE(robot.beams.size() == 8);
  // Sensors 4 and 5 look 22.5 degrees to either side of the way ahead, where the wall is.
  const double ahead = (1.2 - 1.05) / std::cos(22.5 * sim::degree) - 0.0495;
  for (std::size_t i = 0; i < 8; ++i) {
    INFO("sensor " << i + 1);
    CHECK(sim::length(robot.beams[i].from - robot.centre) == Approx(0.0495));
    CHECK(robot.beams[i].meets == (i == 3 || i == 4));
    CHECK(length_of(robot.beams[i]) == Approx(i == 3 || i == 4 ? ahead : 0.2));
  }
  // It drives into the wall.
  world.set_wheels({0.2, 0.2});
  world.advance_to(base::Time{1s});
  const SeenWorld later = sim::seen(world, "AMiRo");
  CHECK(later.time == base::Time{1s});
  CHECK(later.robots[0].touching);
  CHECK(later.robots[0].wheels.left == Approx(0.2).margin(0.01));
}

TEST_CASE("the line on the floor is seen in straight pieces that lie on it") {
  const sim::World world;
  const SeenWorld seen = sim::seen(world, "AMiRo");
  REQUIRE(seen.line.size() > 10);
  double length = 0;
  for (const sim::Segment& piece : seen.line) {
    CHECK(world.options().arena.line.distance(piece.a) == Approx(0).margin(1e-6));
    length += sim::length(piece.b - piece.a);
  }
  CHECK(length == Approx(2 * 0.8 + 2 * sim::pi * 0.4).epsilon(0.01));
}

TEST_CASE("what is seen of mappers: each with its tower, and each other") {
  auto loaded = sim::worlds::find("labyrinth");
  REQUIRE(loaded.world);
  sim::mapper::World world{*loaded.world, {.seed = 1}};
  world.robot(0).show({.green = true, .yellow = false});
  world.robot(1).show({.green = false, .yellow = true});
  world.robot(1).drive({1, 1});
  world.advance_to(base::Time{500ms});
  const SeenWorld seen = sim::seen(world);
  CHECK(seen.name == "labyrinth");
  CHECK(seen.line.empty());
  REQUIRE(seen.robots.size() == 2);
  CHECK(seen.robots[0].name == "AVR");
  CHECK(seen.robots[1].name == "Arduino");
  CHECK(seen.robots[0].lights == std::vector<firmware::boards::Colour>{{0, 255, 0}, {0, 0, 0}});
  CHECK(seen.robots[1].lights == std::vector<firmware::boards::Colour>{{0, 0, 0}, {255, 255, 0}});
  CHECK_FALSE(seen.robots[0].charge);
  CHECK(seen.robots[0].wheels.left == 0);
  CHECK(seen.robots[1].wheels.left > 0.05);
  for (std::size_t i = 0; i < 2; ++i) {
    const SeenRobot& robot = seen.robots[i];
    CHECK(robot.pose == world.robot(i).pose());
    REQUIRE(robot.beams.size() == 4);
    for (const Beam& beam : robot.beams) CHECK(length_of(beam) <= 0.8 + 1e-6);  // [GP2Y0A21YK data sheet]
  }
  // The first looks straight to the left wall behind it: 0.4 m from the axle.
  const Beam& back = seen.robots[0].beams[2];
  CHECK(back.meets);
  CHECK(back.to.x == Approx(0).margin(1e-6));
}

TEST_CASE("a loop that is watched looks up at least twenty times a second") {
  sim::Shell shell;
  CHECK(shell.limited(200ms) == 200ms);
  shell.watch = [](const auto&) {};
  CHECK(shell.limited(200ms) == 50ms);
  CHECK(shell.limited(3ms) == 3ms);
}

}  // namespace sim_serve_seen_test
