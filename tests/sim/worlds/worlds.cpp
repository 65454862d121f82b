// Good worlds mean what they say; and any bytes are at worst a problem.
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "sim/mapper/world.hpp"
#include "sim/worlds/reader.hpp"
#include "tests/sim/worlds/read.hpp"
#include "unit/base/explore.hpp"

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

/// A world of one robot, with more members, each followed by a comma.
std::string with(const std::string& members, const std::string& of_robot = "") {
  return R"({"name":"w",)" + members + R"("robots":[{"name":"A","model":"avr","at":[0,0])" + of_robot + "}]}";
}

TEST_CASE("each number has the bounds that are said, and both are allowed") {
  struct Bounds {
    std::string before, behind, of_robot;
    std::string least, most, below, above, said;
  };
  const std::string walls = R"("walls":[],)";
  const Bounds all[] = {
      {walls + R"("friction":)", ",", "", "0.05", "2", "0.049", "2.01", "from 0.05 to 2 (0.5: the floor"},
      {walls + R"("field":{"gauss":)", "},", "", "0.01", "2", "0.0099", "2.01", "from 0.01 to 2 gauss"},
      {walls + R"("field":{"north":)", "},", "", "-360", "360", "-360.1", "360.1",
       "from -360 to 360 degrees"},
      {walls + R"("anomalies":[{"at":[0,0],"gauss":[0,0],"radius":)", "}],", "", "0.01", "1000", "0.009",
       "1000.1", "from 0.01 to 1000 m"},
      {walls + R"("anomalies":[{"at":[0,0],"radius":1,"gauss":[0,)", "]}],", "", "-8", "8", "-8.1", "8.1",
       "from -8 to 8 gauss"},
      {walls + R"("central":{"at":[0,0],"range":)", "},", "", "0.1", "1000", "0.09", "1000.1",
       "from 0.1 to 1000 m"},
      {walls + R"("central":{"at":[0,0],"loss_at_range":)", "},", "", "0", "1", "-0.1", "1.1",
       "from 0 to 1 (a share of the packets)"},
      {walls + R"("central":{"at":[)", ",0]},", "", "-1000", "1000", "-1000.1", "1000.1",
       "from -1000 to 1000 m"},
      {R"("walls":[[[5,5],[6,)", "]]],", "", "-1000", "1000", "-1000.1", "1000.1", "from -1000 to 1000 m"},
      {walls, "", R"(,"heading":)", "-360", "360", "-360.1", "360.1", "from -360 to 360 degrees"},
  };
  for (const Bounds& each : all) {
    const auto text = [&each](const std::string& number) {
      return each.of_robot.empty() ? with(each.before + number + each.behind)
                                   : with(each.before, each.of_robot + number);
    };
    for (const std::string& number : {each.least, each.most}) {
      CAPTURE(text(number));
      static_cast<void>(good(text(number)));
    }
    for (const std::string& number : {each.below, each.above}) {
      CAPTURE(text(number));
      const auto loaded = ocm::sim::worlds::parse(text(number), "f");
      REQUIRE(loaded.problems.size() == 1);
      CHECK(loaded.problems[0].what == number + " is out of range");
      CHECK(loaded.problems[0].remedy.find("a number " + each.said) == 0);
    }
  }
}

TEST_CASE("a world holds so much, and no more") {
  const auto list = [](std::size_t count, const auto& item) {
    std::string text = "[";
    for (std::size_t i = 0; i < count; ++i) text += (i == 0 ? "" : ",") + item(i);
    return text + "]";
  };
  const auto corner = [](std::size_t i) { return "[" + std::to_string(i) + ",5]"; };
  const auto wall = [&corner](std::size_t) { return "[" + corner(5) + "," + corner(6) + "]"; };
  const auto only = [](const std::string& text) {
    const auto loaded = ocm::sim::worlds::parse(text, "f");
    REQUIRE(loaded.problems.size() == 1);
    CHECK_FALSE(loaded.world);
    return loaded.problems[0].what + "; " + loaded.problems[0].remedy;
  };
  CHECK(good(with(R"("walls":)" + list(1000, wall) + ",")).walls.size() == 1000);
  CHECK(only(with(R"("walls":)" + list(1001, wall) + ",")) ==
        "a list of 1001; a list of at most 1000 walls, [] for none");
  const std::string long_wall = list(1000, corner);
  CHECK(good(with(R"("walls":[)" + long_wall + "," + wall(0) + "],")).walls.size() == 1000);
  CHECK(only(with(R"("walls":[)" + long_wall + "," + wall(0) + "," + wall(0) + "," + wall(0) + "],")) ==
        "more than 1000 pieces of wall; fewer of them");
  CHECK(only(with(R"("walls":[)" + list(1001, corner) + "],")) ==
        "a list of 1001; two or more corners, [[x, y], [x, y]]");
  const auto anomaly = [](std::size_t) { return std::string{R"({"at":[0,0],"radius":1,"gauss":[0,0]})"}; };
  const std::string of_anomalies = R"("walls":[],"anomalies":)";
  CHECK(good(with(of_anomalies + list(100, anomaly) + ",")).anomalies.size() == 100);
  CHECK(only(with(of_anomalies + list(101, anomaly) + ",")) ==
        "a list of 101; a list of at most 100 anomalies");
  const auto robot = [](std::size_t i) {
    return R"({"name":")" + std::to_string(i) + R"(","model":"avr","at":[)" + std::to_string(i) + ",0]}";
  };
  const auto robots = [&](std::size_t count) {
    return R"({"name":"w","walls":[],"robots":)" + list(count, robot) + "}";
  };
  CHECK(good(robots(200)).starts.size() == 200);
  CHECK(only(robots(201)) == "a list of 201; a list of 1 to 200 robots");
  const auto named = [](std::size_t size) {
    return R"({"name":"w","walls":[],"robots":[{"name":")" + std::string(size, 'n') +
           R"(","model":"avr","at":[0,0]}]})";
  };
  CHECK(good(named(20)).starts[0].name == std::string(20, 'n'));
  CHECK(only(named(21)).find("is not a valid name of a robot; 1 to 20 printed ASCII characters") !=
        std::string::npos);
  std::string text = named(1);
  text.resize(ocm::sim::worlds::max_world_bytes, ' ');
  CHECK(text.size() == 1'000'000);
  static_cast<void>(good(text));
  CHECK(only(text + ' ') == "the file has 1000001 bytes; a world has at most 1000000");
}

TEST_CASE("a robot may touch a wall and another robot, and is no nearer to them") {
  // The middle of a robot is 1 cm behind the place at which it starts.
  const auto problems_of = [](const std::string& wall_y, const std::string& second_y) {
    return printed(ocm::sim::worlds::parse(R"({"name":"w","walls":[[[-0.01,)" + wall_y + "],[1," + wall_y +
                                               R"(]]],"robots":[{"name":"A","model":"avr","at":[0,0]},)" +
                                               R"({"name":"B","model":"avr","at":[0,)" + second_y + "]}]}",
                                           "f")
                       .problems);
  };
  CHECK(problems_of("-0.1", "0.2").empty());
  CHECK(problems_of("-0.099", "0.2") ==
        std::vector<std::string>{"f:1: /robots/0/at: robot \"A\" is inside a wall: it has a radius of 0.1 m, "
                                 "and the wall is 0.099 m from its middle; a place with more room"});
  CHECK(problems_of("-0.1", "0.199") ==
        std::vector<std::string>{"f:1: /robots/1/at: robot \"B\" overlaps robot \"A\"; at least 0.2 m from "
                                 "middle to middle"});
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
  const int runs = ocm::test::explored(20'000);
  for (int i = 0; i < runs; ++i) {
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
  CHECK(good_ones > runs / 200);  // some changes do not matter: the test reaches beyond the parser
}

}  // namespace sim_worlds_worlds_test
