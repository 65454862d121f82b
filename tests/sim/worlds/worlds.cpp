// Good worlds mean what they say; and any bytes are at worst a problem.
#include <cmath>
#include <random>
#include <string>

#include <catch2/catch.hpp>

#include "sim/mapper/world.hpp"
#include "sim/worlds/reader.hpp"
#include "tests/sim/worlds/read.hpp"

namespace sim_worlds_worlds_test {

using namespace ocm::sim;
using namespace ocm::sim::mapper;

WorldModel good(std::string_view text) {
  auto loaded = ocm::sim::worlds::parse(text, "f");
  CHECK(printed(loaded.problems).empty());
  REQUIRE(loaded.world);
  return *loaded.world;
}

/// Of a closed line of corners, the first walls of a world.
double area(const std::vector<Segment>& walls, std::size_t sides) {
  double twice = 0;
  for (std::size_t i = 0; i < sides; ++i) twice += cross(walls[i].a, walls[i].b);
  return twice / 2;
}

TEST_CASE("a world is what its file says") {
  const WorldModel world = good(read("tests/sim/worlds/good.json"));
  CHECK(world.name == "yard");
  CHECK(world.friction == 0.5);
  CHECK(world.field_gauss == 0.2);
  CHECK(world.north_rad == Approx(80 * degree));
  REQUIRE(world.walls.size() == 3);
  CHECK(world.walls[1].a == Vector{3, 0});
  CHECK(world.walls[1].b == Vector{3, 2});
  CHECK(world.walls[2].a == Vector{1, 1});
  REQUIRE(world.anomalies.size() == 1);
  CHECK(world.anomalies[0].place == Vector{2, 1});
  CHECK(world.anomalies[0].radius_m == 0.4);
  CHECK(world.anomalies[0].field_gauss == Vector{0.1, -0.05});
  CHECK(world.central.place == Vector{0, 1});
  CHECK(world.central.range_m == 5);
  CHECK(world.central.loss_at_range == 0.25);
  REQUIRE(world.starts.size() == 2);
  CHECK(world.starts[0].name == "AVR");
  CHECK(world.starts[0].kind == RobotKind::avr);
  CHECK(world.starts[0].pose == Pose{0.5, 0.5, 90 * degree});
  CHECK(world.starts[1].kind == RobotKind::arduino);
  CHECK(world.starts[1].pose == Pose{2, 1.5, 0});
}

TEST_CASE("a number may be the least and the most of its range") {
  for (const char* const friction : {"0.05", "2"}) {
    CAPTURE(friction);
    CHECK(good(R"({"name":"w","walls":[],"friction":)" + std::string{friction} +
               R"(,"robots":[{"name":"A","model":"avr","at":[-1000,1000]}]})")
              .friction == std::stod(friction));
  }
}

TEST_CASE("what a world does not say is as documented") {
  const WorldModel world =
      good(R"({"name":"w","walls":[],"robots":[{"name":"A","model":"avr","at":[1,2]}]})");
  CHECK(world.friction == 0.5);
  CHECK(world.field_gauss == 0.14);
  CHECK(world.north_rad == Approx(pi / 2));
  CHECK(world.central.place == Vector{0, 0});
  CHECK(world.central.range_m == 8);
  CHECK(world.central.loss_at_range == 0.5);
  CHECK(world.anomalies.empty());
}

TEST_CASE("the worlds that are compiled in are the files, and good") {
  CHECK(ocm::sim::worlds::built_in_names() == std::vector<std::string_view>{"labyrinth", "range", "square"});
  CHECK_FALSE(ocm::sim::worlds::built_in("nowhere"));
  for (const auto name : ocm::sim::worlds::built_in_names()) {
    CAPTURE(name);
    const auto file = std::string{OCM_SOURCE_DIR} + "/sim/worlds/" + std::string{name} + ".json";
    CHECK(*ocm::sim::worlds::built_in(name) == read("sim/worlds/" + std::string{name} + ".json"));
    const auto loaded = ocm::sim::worlds::load(file);
    CHECK(printed(loaded.problems).empty());
    REQUIRE(loaded.world);
    CHECK(loaded.world->name == name);
  }
}

TEST_CASE("the square room leaves the path of table 13.1 half a metre of room") {
  const WorldModel world = good(*ocm::sim::worlds::built_in("square"));
  REQUIRE(world.starts.size() == 1);
  // {0,60} {90,130} {90,120} {90,130} {85,52}, as it should be.
  const Vector corners[] = {{0, 0}, {0.6, 0}, {0.6, 1.3}, {-0.6, 1.3}, {-0.6, 0}, {-0.08, 0}};
  for (std::size_t i = 0; i + 1 < std::size(corners); ++i)
    for (double part = 0; part <= 1; part += 0.05)
      for (const Segment& wall : world.walls) {
        const Vector at = corners[i] + (corners[i + 1] - corners[i]) * part;
        CHECK(length(at - nearest_point(wall, at)) >= 0.5);
      }
}

TEST_CASE("the labyrinth has 4.38 square metres, two robots and two anomalies") {
  const WorldModel world = good(*ocm::sim::worlds::built_in("labyrinth"));
  CHECK(area(world.walls, 4) == Approx(4.38));
  CHECK(world.starts.size() == 2);
  CHECK(world.anomalies.size() == 2);
  for (const Anomaly& anomaly :
       world.anomalies) {  // strong enough to turn a compass far beyond its 2 degrees
    const Vector field = world.field_at(anomaly.place);
    const double turned = std::atan2(field.y, field.x) - world.north_rad;
    CHECK(std::abs(turned) > 15 * degree);
  }
}

TEST_CASE("the corridor is longer than the radio reaches") {
  const WorldModel world = good(*ocm::sim::worlds::built_in("range"));
  double farthest = 0;
  for (const Segment& wall : world.walls) farthest = std::max(farthest, length(wall.a - world.central.place));
  CHECK(farthest > 2 * world.central.range_m);
  for (const Start& start : world.starts)
    CHECK(length(start.pose.position() - world.central.place) < world.central.range_m / 2);
}

/// What must hold for every text; returns whether it was a world.
bool accepted(std::string_view text) {
  const auto loaded = ocm::sim::worlds::parse(text, "f");
  if (loaded.world.has_value() != loaded.problems.empty())
    FAIL("a world with problems, or neither: " << text);
  for (const auto& p : loaded.problems)
    if (p.place.empty() || p.what.empty() || p.remedy.empty()) FAIL("a problem without words: " << text);
  if (!loaded.world) return false;
  for (const Start& start : loaded.world->starts)
    if (room_m(start, loaded.world->walls, loaded.world->starts) < -1e-12)
      FAIL("a robot without room: " << text);
  for (const Segment& wall : loaded.world->walls)
    if (!(length(wall.a - wall.b) > 0)) FAIL("a wall of no length: " << text);
  return true;
}

TEST_CASE("a world that is cut off anywhere is reported as such") {
  const std::string whole = read("tests/sim/worlds/good.json");
  const std::size_t end = whole.rfind('}');
  for (std::size_t n = 0; n <= end; ++n)
    if (accepted(std::string_view{whole}.substr(0, n))) FAIL("accepted after " << n << " bytes");
  CHECK(accepted(whole));
}

TEST_CASE("mutated worlds never crash, and are accepted or told why not") {
  const std::string worlds[] = {read("tests/sim/worlds/good.json"), read("sim/worlds/labyrinth.json")};
  const std::vector<std::string> pieces = {"{",    "}",    "[",  "]",    ",",    ":",      "\"",
                                           "null", "true", "-1", "0",    "1e99", "-1e-99", "1e400",
                                           "NaN",  "[]",   "{}", "\"\"", "\\",   "\xFF"};
  std::mt19937 random{1};
  const auto pick = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  int good_ones = 0;
  for (int i = 0; i < 20'000; ++i) {
    std::string text = worlds[pick(2)];
    for (std::size_t n = 1 + pick(3); n > 0; --n) {
      const std::size_t at = pick(text.size());
      if (pick(3) == 0)
        text.erase(at, 1 + pick(6));
      else if (pick(2) == 0)
        text.replace(at, 1 + pick(3), pieces[pick(pieces.size())]);
      else
        text[at] = static_cast<char>('0' + pick(10));
      if (text.empty()) break;
    }
    good_ones += accepted(text);
  }
  CHECK(good_ones > 100);  // some changes do not matter: the test reaches beyond the parser
}

}  // namespace sim_worlds_worlds_test
