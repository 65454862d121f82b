#include "cli/simulate/room_view.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include <catch2/catch.hpp>

#include "ocm/base/utf8.hpp"

#include "sim/amiro/world.hpp"
#include "tests/tool/golden.hpp"

namespace simulate_room_view_test {

using namespace ocm;
using namespace ocm::cli;
using namespace ocm::cli::simulate;
using namespace std::chrono_literals;
using test::is_as_in;

std::string text_of(const top::Picture& picture) {
  std::string text;
  for (const top::Line& line : picture) {
    std::string whole;
    for (const top::Piece& piece : line) whole += piece.text;
    whole.erase(whole.find_last_not_of(' ') + 1);
    text += whole + '\n';
  }
  return text;
}

/// Each line, and below it how many columns each style has.
std::string styled(const top::Picture& picture) {
  static constexpr std::string_view names[] = {"plain",    "dim",  "bold",    "heading", "sorted",
                                               "selected", "good", "warning", "bad"};
  std::string text;
  for (const top::Line& line : picture) {
    std::string words, styles;
    for (const top::Piece& piece : line) {
      words += piece.text;
      styles += ' ' + std::string{names[static_cast<std::size_t>(piece.style)]} + ':' +
                std::to_string(base::columns(piece.text));
    }
    text += '|' + words + "|\n" + (styles.empty() ? "" : "   " + styles + '\n');
  }
  return text;
}

/// Has driven an arc of the line, with its lights on.
sim::SeenWorld driven(Trails& trails) {
  sim::World world;
  world.set_wheels({0.2, 0.2});
  for (std::size_t i = 0; i < 4; ++i) world.set_light(i, {0, 200, 20});
  world.set_light(6, {255, 255, 0});
  for (base::Time now{}; now <= base::Time{4s}; now += 100ms) {
    if (now == base::Time{2s}) world.set_wheels({0.14, 0.2});
    world.advance_to(now);
    trails.take(sim::seen(world, "AMiRo"));
  }
  return sim::seen(world, "AMiRo");
}

sim::SeenWorld two_mappers() {
  sim::SeenWorld world{"hall", base::Time{90s}};
  const sim::Vector corners[] = {{0, 0}, {2, 0}, {2, 1}, {0, 1}};
  for (int i = 0; i < 4; ++i) world.walls.push_back({corners[i], corners[(i + 1) % 4]});
  sim::SeenRobot first{"AVR", {0.5, 0.5, 0}, {0.49, 0.5}, 0.1, {0.069, 0.069}};
  first.beams = {{{0.6, 0.5}, {1.4, 0.5}, false}, {{0.5, 0.6}, {0.5, 1.0}, true}};
  first.lights = {{0, 255, 0}, {}};
  sim::SeenRobot second{
      "a_robot_with_a_long_name", {1.5, 0.5, 3 * sim::pi / 4}, {1.5, 0.5}, 0.1, {-0.05, 0.05}};
  second.touching = true;
  world.robots = {first, second};
  return world;
}

TEST_CASE("room view: the AMiRo in its room, as it was looked at") {
  Trails trails;
  const sim::SeenWorld world = driven(trails);
  const RoomScene scene{.bus = "sim"};
  is_as_in("tests/tool/simulate/golden/amiro_80x24.txt",
           text_of(draw_room(world, trails, scene, {80, 24}, true)));
  is_as_in("tests/tool/simulate/golden/amiro_80x24_ascii.txt",
           text_of(draw_room(world, trails, scene, {80, 24}, false)));
  is_as_in("tests/tool/simulate/golden/amiro_120x40.txt",
           text_of(draw_room(world, trails, scene, {120, 40}, true)));
  is_as_in("tests/tool/simulate/golden/amiro_40x20.txt",
           text_of(draw_room(world, trails, scene, {40, 20}, true)));
}

TEST_CASE("room view: mappers in theirs, each with its number") {
  const sim::SeenWorld world = two_mappers();
  is_as_in("tests/tool/simulate/golden/mappers_80x24.txt",
           text_of(draw_room(world, {}, {.speed = 10, .chosen = 0}, {80, 24}, true)));
  is_as_in("tests/tool/simulate/golden/mappers_80x24_ascii.txt",
           text_of(draw_room(world, {}, {.speed = 10, .chosen = 1}, {80, 24}, false)));
}

TEST_CASE("room view: each thing has its style, and what is chosen or touches something another one") {
  Trails trails;
  sim::SeenWorld world = two_mappers();
  world.line.push_back({{0.2, 0.9}, {1.8, 0.9}});
  for (int i = 0; i < 5; ++i) {
    world.robots[0].centre.x = 0.3 + i * 0.05;
    trails.take(world);
  }
  std::string all;
  for (const std::size_t chosen : {0U, 1U})
    for (const TerminalSize size : {TerminalSize{64, 16}, TerminalSize{40, 14}, TerminalSize{63, 7}})
      all += styled(draw_room(world, trails, {.speed = 0.5, .bus = "sim", .chosen = chosen}, size, true));
  all += styled(draw_room(world, trails, {.beams = false, .message = "the bus is down"}, {64, 16}, false));
  is_as_in("tests/tool/simulate/golden/styles.txt", all);
}

sim::SeenWorld twelve_mappers() {
  sim::SeenWorld world = two_mappers();
  world.robots.resize(1);
  for (int i = 1; i < 12; ++i) {
    sim::SeenRobot robot = world.robots[0];
    robot.name = "robot_" + std::to_string(i);
    robot.pose = {0.15 * i, 0.25, 2 * sim::pi * i / 11};
    robot.centre = robot.pose.position();
    robot.beams.clear();
    world.robots.push_back(robot);
  }
  return world;
}

TEST_CASE("room view: more robots than digits, and than lines beside the room") {
  const sim::SeenWorld world = twelve_mappers();
  std::string all;
  for (const std::size_t rows : {30U, 24U, 23U, 22U, 12U})
    all += text_of(draw_room(world, {}, {.chosen = 10}, {100, rows}, rows != 24));
  is_as_in("tests/tool/simulate/golden/many_robots.txt", all);
}

TEST_CASE(
    "room view: the last robot of the list may have the last line, which else says how many there are") {
  const sim::SeenWorld world = twelve_mappers();
  // The chosen one has seven lines, a blank one is behind them, and the others have eleven.
  const auto drawn = [&world](std::size_t rows) {
    return text_of(draw_room(world, {}, {.chosen = 10}, {100, rows + 2}, false));
  };
  CHECK(drawn(19).find("+ robot_11  1.65  0.25") != std::string::npos);
  CHECK(drawn(19).find(" more\n") == std::string::npos);
  CHECK(drawn(18).find("9 robot_8   1.20  0.25") != std::string::npos);
  CHECK(drawn(18).find("robot_9 ") == std::string::npos);
  CHECK(drawn(18).find("and 2 more\n") != std::string::npos);
}

TEST_CASE("room view: a light is the letter of its nearest colour") {
  sim::SeenWorld world = two_mappers();
  world.robots[0].lights = {{0, 0, 255}, {0, 200, 0},     {0, 200, 100}, {255, 0, 0},   {90, 0, 90},
                            {9, 8, 0},   {255, 255, 255}, {255, 127, 0}, {255, 128, 0}, {0, 1, 0},
                            {},          {100, 50, 49},   {49, 100, 50}};
  const auto drawn = [&](TerminalSize size) { return text_of(draw_room(world, {}, {}, size, true)); };
  CHECK(drawn({60, 24}).find("lights bgcrmywryg.yc") != std::string::npos);
}

TEST_CASE("room view: fits any terminal, and says where the robot is on all that have a line for it") {
  Trails trails;
  const sim::SeenWorld amiro = driven(trails);
  const sim::SeenWorld mappers = two_mappers();
  for (const sim::SeenWorld* const world : {&amiro, &mappers})
    for (const bool unicode : {false, true})
      for (std::size_t columns = 1; columns < 210; columns += 7)
        for (std::size_t rows = 1; rows < 60; rows += 3) {
          const auto picture = draw_room(*world, trails, {}, {columns, rows}, unicode);
          REQUIRE(picture.size() == rows);
          for (const top::Line& line : picture) {
            std::size_t used = 0;
            for (const top::Piece& piece : line) used += base::columns(piece.text);
            REQUIRE(used <= columns);
          }
          if (columns >= 40 && rows >= 8) CHECK(text_of(picture).find("x ") != std::string::npos);
        }
}

TEST_CASE("room view: a room takes six lines and columns at least") {
  Trails trails;
  const sim::SeenWorld world = driven(trails);
  const auto has_walls = [&](TerminalSize size) {
    return text_of(draw_room(world, trails, {}, size, false)).find("####") != std::string::npos;
  };
  CHECK(has_walls({80, 8}));  // and one of its head, one of its foot
  CHECK_FALSE(has_walls({80, 7}));
  CHECK(has_walls({6, 12}));  // and four of the state below
  CHECK_FALSE(has_walls({6, 11}));
  CHECK_FALSE(has_walls({5, 12}));
}

TEST_CASE("room view: what changes is seen") {
  Trails trails;
  sim::SeenWorld world = two_mappers();
  const auto drawn = [&](const RoomScene& scene = {}) {
    return text_of(draw_room(world, trails, scene, {80, 24}, true));
  };
  const std::string before = drawn();
  CHECK(before.find("→1") != std::string::npos);
  CHECK(before.find("↖2") != std::string::npos);
  CHECK(before.find("1 AVR  of 2") != std::string::npos);
  CHECK(before.find("-  0.40") != std::string::npos);  // beams in metres: nothing there, and a wall
  CHECK(before.find("g .") != std::string::npos);      // lights
  CHECK(drawn({.beams = false}) != before);
  CHECK(drawn({.chosen = 1}).find("touches something") != std::string::npos);
  CHECK(drawn({.chosen = 7}).find("2 a_robot_with_a_long_na") != std::string::npos);
  CHECK(drawn({.speed = 10}).find("x10") != std::string::npos);
  CHECK(drawn({.message = "the bus is down"}).find("the bus is down") != std::string::npos);
  world.robots[0].pose.heading_rad = -sim::pi / 2;
  CHECK(drawn().find("↓1") != std::string::npos);
  CHECK(drawn().find("-90.0 deg") != std::string::npos);
  // A trail is drawn where the robot was, and can be begun again.
  trails.take(world);
  for (int i = 0; i < 10; ++i) {
    world.robots[0].centre.x += 0.05;
    trails.take(world);
  }
  const std::string with_trail = drawn();
  trails.forget();
  CHECK(with_trail != drawn());
}

TEST_CASE("room view: trails have an end, and a robot at rest adds nothing to its own") {
  Trails trails;
  sim::SeenWorld world = two_mappers();
  trails.take(world);
  trails.take(world);
  CHECK(trails.of("AVR").size() == 1);
  CHECK(trails.of("no robot").empty());
  for (std::size_t i = 0; i < Trails::most + 100; ++i) {
    world.robots[0].centre.x += Trails::apart_m * 1.01;
    trails.take(world);
  }
  CHECK(trails.of("AVR").size() == Trails::most);
  CHECK(trails.of("AVR").back().x == Approx(world.robots[0].centre.x));
  CHECK(trails.of("a_robot_with_a_long_name").size() == 1);
}

TEST_CASE("room view: a trail goes on where the robot has come two centimetres further, and not before") {
  Trails trails;
  sim::SeenWorld world = two_mappers();
  world.robots[0].centre = {0, 0};
  trails.take(world);
  world.robots[0].centre.x = Trails::apart_m;
  trails.take(world);
  CHECK(trails.of("AVR").size() == 2);
  world.robots[0].centre.x = 2 * Trails::apart_m - 0.0001;
  trails.take(world);
  CHECK(trails.of("AVR").size() == 2);
}

TEST_CASE("room view: a key is named where its words have room, up to the last column") {
  const sim::SeenWorld world = two_mappers();
  const auto foot = [&world](std::size_t columns) {
    const std::string text = text_of(draw_room(world, {}, {}, {columns, 24}, false));
    return text.substr(text.rfind('\n', text.size() - 2) + 1);
  };
  CHECK(foot(5) == "\n");
  CHECK(foot(6) == "q quit\n");
  CHECK(foot(14) == "q quit\n");
  CHECK(foot(15) == "q quit  b beams\n");
  CHECK(foot(27) == "q quit  b beams\n");
  CHECK(foot(28) == "q quit  b beams  t new trail\n");
  CHECK(foot(43) == "q quit  b beams  t new trail\n");
  CHECK(foot(44) == "q quit  b beams  t new trail  Tab next robot\n");
}

TEST_CASE("room view: below the room it is said how near the nearest thing is that a beam meets") {
  sim::SeenWorld world = two_mappers();
  auto& beams = world.robots[0].beams;
  const auto says = [&world](const char* line) {
    return text_of(draw_room(world, {}, {}, {40, 20}, true)).find(line) != std::string::npos;
  };
  // The shortest of them meets nothing.
  beams = {{{0.6, 0.5}, {0.7, 0.5}, false}, {{0.5, 0.6}, {0.5, 1.0}, true}, {{0.4, 0.5}, {0.1, 0.5}, true}};
  CHECK(says("\nlights g.  nearest 0.30 m\n"));
  std::swap(beams[1], beams[2]);
  CHECK(says("\nlights g.  nearest 0.30 m\n"));
  for (sim::Beam& beam : beams) beam.meets = false;
  CHECK(says("\nlights g.\n"));
}

TEST_CASE("room view: what is in a world decides what there is room for") {
  // Line and column of the first thing that is drawn: 54 columns and 21 lines are for the room.
  const auto place_of = [](const sim::SeenWorld& world, std::string_view what) {
    const auto picture = draw_room(world, {}, {.beams = false}, {80, 23}, false);
    for (std::size_t row = 1; row + 1 < picture.size(); ++row) {
      std::string text;
      for (const top::Piece& piece : picture[row]) text += piece.text;
      if (const auto at = text.substr(0, 54).find(what); at != std::string::npos) return std::pair{row, at};
    }
    return std::pair{std::size_t{0}, std::size_t{0}};
  };
  // Without walls a robot has a metre around it, and so is in the middle of 2 m that are 21 lines high.
  sim::SeenWorld open{"open", base::Time{}};
  open.robots.push_back({"one", {7, -3, 0}, {7, -3}, 0.1, {}});
  CHECK(place_of(open, ">") == std::pair{std::size_t{11}, std::size_t{20}});
  // Two that are 4 m apart are a metre from the edges each.
  open.robots.push_back({"two", {11, -3, sim::pi / 2}, {11, -3}, 0.1, {}});
  CHECK(place_of(open, ">") == std::pair{std::size_t{5}, std::size_t{9}});
  CHECK(place_of(open, "^") == std::pair{std::size_t{5}, std::size_t{44}});
  // One wall is a world, too, whichever way it goes.
  sim::SeenWorld wall{"wall", base::Time{}};
  wall.walls.assign(1, sim::Segment{{5, 1}, {5, 2}});
  CHECK(place_of(wall, "#") == std::pair{std::size_t{1}, std::size_t{0}});
  wall.walls.assign(1, sim::Segment{{5, 1}, {6, 1}});
  CHECK(place_of(wall, "####") == std::pair{std::size_t{1}, std::size_t{0}});
}

TEST_CASE("room view: the room begins at its upper left edges, and ends before the others") {
  // 54 columns and 21 lines are for it: one is 0.25 m wide and 0.5 m high.
  sim::SeenWorld world{"edges", base::Time{}};
  world.walls.push_back({{0, 0}, {0, 0}});
  world.walls.push_back({{13.25, -1}, {13.25, -1}});
  // Where a piece of a line is drawn that is no longer than a dot: "column,line".
  const auto drawn_at = [&world](sim::Vector at) {
    world.line.assign(1, sim::Segment{at, at});
    const auto picture = draw_room(world, {}, {}, {80, 23}, false);
    std::string places;
    for (std::size_t row = 1; row + 1 < picture.size(); ++row) {
      std::string text;
      for (const top::Piece& piece : picture[row]) text += piece.text;
      for (std::size_t i = 0; i < text.size(); ++i)
        if (text[i] == ':') places += std::to_string(i) + ',' + std::to_string(row - 1);
    }
    return places;
  };
  CHECK(drawn_at({-0.125, -0.5}) == "0,1");
  CHECK(drawn_at({-0.126, -0.5}).empty());
  CHECK(drawn_at({13.374, -0.5}) == "53,1");
  CHECK(drawn_at({13.375, -0.5}).empty());
  CHECK(drawn_at({1, 0.25}) == "4,0");
  CHECK(drawn_at({1, 0.251}).empty());
  CHECK(drawn_at({1, -10.249}) == "4,20");
  CHECK(drawn_at({1, -10.25}).empty());
}

TEST_CASE("room view: in letters a line has one a column, or where it is steep one a row") {
  // As above: a column is 0.25 m wide, a row 0.5 m high, and 0, 0 is in the middle of the first.
  sim::SeenWorld world{"edges", base::Time{}};
  world.walls.push_back({{0, 0}, {0, 0}});
  world.walls.push_back({{13.25, -1}, {13.25, -1}});
  const auto drawn = [&world](sim::Vector from, sim::Vector to) {
    world.line.assign(1, sim::Segment{from, to});
    const auto picture = draw_room(world, {}, {}, {80, 23}, false);
    std::string places;
    for (std::size_t row = 1; row + 1 < picture.size(); ++row) {
      std::string text;
      for (const top::Piece& piece : picture[row]) text += piece.text;
      for (std::size_t i = 0; i < text.size(); ++i)
        if (text[i] == ':') places += std::to_string(i) + ',' + std::to_string(row - 1) + ' ';
    }
    return places;
  };
  // From the column 4.3 and the row 1.4 to 5.5 and 5.3; and from 4.4 and 1.3 to 8.3 and 2.5.
  CHECK(drawn({0.95, -0.45}, {1.25, -2.4}) == "4,1 4,2 4,3 5,4 5,5 ");
  CHECK(drawn({0.975, -0.4}, {1.95, -1.0}) == "4,1 5,1 6,1 7,2 8,2 ");
}

TEST_CASE("room view: figures that no world has do no harm") {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double endless = std::numeric_limits<double>::infinity();
  for (const double odd : {nan, endless, -endless, 1e300}) {
    sim::SeenWorld world = two_mappers();
    world.robots[0].pose = {odd, odd, odd};
    world.robots[0].centre = {odd, odd};
    world.robots[0].beams[0].to = {odd, odd};
    CHECK(draw_room(world, {}, {}, {80, 24}, true).size() == 24);
  }
  // Without a robot, wherever its state would be.
  for (const TerminalSize size : {TerminalSize{80, 24}, TerminalSize{40, 24}, TerminalSize{80, 7}})
    CHECK(draw_room({}, {}, {}, size, true).size() == size.rows);
  sim::SeenWorld open = two_mappers();  // without walls
  open.walls.clear();
  CHECK(text_of(draw_room(open, {}, {}, {80, 24}, true)).find("→1") != std::string::npos);
}

}  // namespace simulate_room_view_test
