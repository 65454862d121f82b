// What is known before robots drive: where they begin, and the world that they are in.
#include "cli/fleet/known.hpp"

#include <cstddef>
#include <fstream>
#include <string>
#include <unistd.h>

#include <catch2/catch.hpp>

#include "cli/shared/messages.hpp"
#include "sim/worlds/reader.hpp"
#include "tests/tool/captured.hpp"
#include "tests/unit/host/host_testing.hpp"

namespace fleet_known_test {

using namespace ocm;
using namespace ocm::test;
using cli::fleet::known_of;
using cli::fleet::parse_start;

TEST_CASE("known: a start is a name, a place in metres and a heading in degrees") {
  const auto start = parse_start("map", "AVR=0.5,-1.25,90");
  CHECK(start.name == "AVR");
  CHECK(start.pose.x_m == 0.5F);
  CHECK(start.pose.y_m == -1.25F);
  CHECK(start.pose.heading_rad == Approx(motion::pi / 2));
}

TEST_CASE("known: what is no start is refused with what is expected") {
  for (const char* const text : {"", "AVR", "=1,2,3", "AVR=", "AVR=1", "AVR=1,2", "AVR=1,2,3,4", "AVR=1,2,3 ",
                                 "AVR=1,2,x", "AVR=nan,2,3", "AVR=1,inf,3", "AVR=2000,0,0", "AVR=1;2;3"}) {
    Captured err{STDERR_FILENO};
    int code = 0;
    try {
      static_cast<void>(parse_start("map", text));
    } catch (const cli::Exit& exit) {
      code = exit.code;
    }
    const std::string said = err.text();
    CAPTURE(text, said);
    CHECK(code == 2);
    CHECK(said.find(std::string{"map: --start "} + text + ": no start\n") != std::string::npos);
    CHECK(said.find("write NAME=X,Y,DEG: metres and degrees, as in AVR=0.5,0.5,90") != std::string::npos);
  }
}

TEST_CASE("known: starts that are typed go before those of a world") {
  const auto nothing = known_of("map", "", {});
  CHECK(nothing.walls.empty());
  CHECK(nothing.starts.empty());
  CHECK_FALSE(nothing.central);
  const auto world = known_of("map", "labyrinth", {});  // sim/worlds/labyrinth.json
  CHECK(world.walls.size() == 10);
  CHECK(world.walls[1].from.x_m == 2.19F);
  CHECK(world.walls[1].to.y_m == 2);
  REQUIRE(world.central);
  CHECK(world.central->x_m == -0.5F);
  CHECK(world.central->y_m == 1);
  CHECK(world.range_m == 8);
  REQUIRE(world.starts.size() == 2);
  CHECK(world.starts[0].name == "AVR");
  CHECK(world.starts[0].pose.x_m == 0.4F);
  CHECK(world.starts[1].pose.heading_rad == Approx(motion::pi / 2));
  REQUIRE(world.inside.size() == 2);
  CHECK(world.inside[1].x_m == 1.8F);
  CHECK(world.inside[1].y_m == 0.35F);
  const std::string first = world.starts[0].name;
  const auto both = known_of("map", "labyrinth", {first + "=0.25,0.75,180", "new=1,1,0"});
  REQUIRE(both.starts.size() == world.starts.size() + 1);
  CHECK(both.starts[0].name == world.starts[1].name);
  CHECK(both.starts[both.starts.size() - 2].name == first);
  CHECK(both.starts[both.starts.size() - 2].pose.y_m == 0.75F);
  CHECK(both.inside.size() == world.inside.size() + 2);
  CHECK(both.inside.back().x_m == 1);
  CHECK(both.walls.size() == world.walls.size());
}

TEST_CASE("known: of a world with mistakes each is said, the first one last, with what to do") {
  const TemporaryDirectory folder;
  const std::string file = folder.path() + "/bad.json";
  std::ofstream{file} << R"({"name": "bad", "wall": [], "robot": []})";
  const auto problems = sim::worlds::find(file).problems;
  REQUIRE(problems.size() >= 3);
  std::string expected;
  for (std::size_t i = 1; i < problems.size(); ++i) expected += sim::worlds::in_words(problems[i]) + "\n";
  expected +=
      "amiroctl: map: " + sim::worlds::in_words(problems[0]) + "\n          " + problems[0].remedy + "\n";
  const auto left = leaving([&] { static_cast<void>(known_of("map", file, {})); });
  CHECK(left.code == cli::exit_failure);
  CHECK(left.text == expected);
}

}  // namespace fleet_known_test
