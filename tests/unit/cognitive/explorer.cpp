#include "ocm/cognitive/explorer.hpp"

#include <array>
#include <chrono>
#include <cmath>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "unit/base/explore.hpp"
#include "unit/base/random.hpp"
#include "unit/cognitive/testing/drawing.hpp"

namespace cognitive_explorer_test {

using namespace std::chrono_literals;
using namespace ocm::cognitive;
using ocm::base::Time;
using ocm::mapper::link::SetPoint;
using ocm::motion::Point;
using ocm::motion::Pose;
using ocm::test::map_of;
using ocm::test::middle_of;
using ocm::test::Random;
using Kind = Order::Kind;

/// For cells of 10 cm: a robot without a body, every hole counts.
ExplorerOptions options() {
  ExplorerOptions options;
  options.margin_m = 0.01F;
  options.least_unknown = 1;
  options.least_gain = 1;
  options.longest_m = 3.0F;
  return options;
}
Scout scout(std::uint8_t robot, const Map& map, Cell cell, float heading = 0.0F) {
  Shape shape;
  shape.width_m = shape.length_m = 0.02F;
  const Point p = middle_of(map, cell);
  return {robot, {{p.x_m, p.y_m, heading}, shape}, false, false};
}

TEST_CASE("explorer: set points by hand") {
  CHECK(set_point_to({0, 0, 0}, {1.0F, 0.0F}, 3.0F) == SetPoint{0, 100});
  CHECK(set_point_to({0, 0, 0}, {0.0F, 0.509F}, 3.0F) == SetPoint{90, 50});
  CHECK(set_point_to({1, 1, ocm::motion::pi / 2}, {0.5F, 1.0F}, 3.0F) == SetPoint{90, 50});
  CHECK(set_point_to({0, 0, 0}, {0.0F, -2.0F}, 0.6F) == SetPoint{-90, 60});
  CHECK(set_point_to({0, 0, 0}, {0.0F, 0.0F}, 3.0F) == SetPoint{0, 0});
  // Never more than a set point holds.
  CHECK(set_point_to({0, 0, 0}, {900.0F, 0.0F}, 1e9F) == SetPoint{0, 30'000});
}

TEST_CASE("explorer: frontiers by hand") {
  const Map map = map_of({"#####",  //
                          "#...#",  //
                          "#... ",  //
                          "#. .#",  //
                          "#####"});
  // The hole at 2, 1 is one cell large; the opening at 4, 2 is connected to all that is around.
  const auto all = frontiers(map, 1);
  CHECK(all == std::vector<Cell>{{1, 1}, {3, 1}, {2, 2}, {3, 2}});
  CHECK(frontiers(map, 2) == std::vector<Cell>{{3, 2}});
  // What is around the map is unknown, too.
  CHECK(frontiers(map_of({"##", "..", "##"}), 1) == std::vector<Cell>{{0, 1}, {1, 1}});
  CHECK(frontiers(Map{}, 1).empty());
  CHECK(frontiers(map_of({"###", "#.#", "###"}), 1).empty());
}

TEST_CASE("explorer: drives to where the border is seen, looks, and gives it up when it stays") {
  const Map map = map_of({"##########",  //
                          "#.........",  //
                          "##########"});
  Explorer explorer{options()};
  std::array robots{scout(0, map, {1, 1})};
  Order order = explorer.next(0, robots, map, Time{});
  REQUIRE(order.kind == Kind::drive);
  REQUIRE(order.set_point.angle == 0);
  CHECK(order.set_point.distance >= 30);
  CHECK(order.set_point.distance <= 80);
  REQUIRE(explorer.goal(0));
  unsigned looks = 0;
  Time now{};
  for (int i = 0; i < 100 && order.kind != Kind::done; ++i) {
    if (order.kind == Kind::drive) {
      robots[0].body.pose.x_m += static_cast<float>(order.set_point.distance) / 100.0F;
      now += 1s;
    } else {
      REQUIRE(order.kind == Kind::look);
      if (now < order.until) now = order.until;
      ++looks;
    }
    order = explorer.next(0, robots, map, now);
  }
  CHECK(order.kind == Kind::done);
  CHECK(looks == 3);
  CHECK_FALSE(explorer.goal(0));
  CHECK(robots[0].body.pose.x_m < 1.0F);
}

TEST_CASE("explorer: drives to the next corner of a way, not past it") {
  const Map map = map_of({"#####.##", "#####.##", "#####.##", "#####.##", "#####.##", "#####.##", "#####.##",
                          "#......#", "########"});
  ExplorerOptions near = options();
  near.view_m = 0.2F;
  Explorer explorer{near};
  const std::array robots{scout(0, map, {1, 1})};
  const Order order = explorer.next(0, robots, map, Time{});
  REQUIRE(order.kind == Kind::drive);
  CHECK(order.set_point.angle == 0);
  CHECK(order.set_point.distance >= 37);
  CHECK(order.set_point.distance <= 40);
}

TEST_CASE("explorer: a robot that is closer to a wall than it may come drives away from it") {
  // Cells of 2 cm.
  std::vector<std::string> rows(20, "#" + std::string(60, '.'));
  rows.insert(rows.begin(), std::string(61, '#'));
  rows.push_back(std::string(61, '#'));
  const Map map = map_of(rows, 0.02F);
  ExplorerOptions near = options();
  near.view_m = 0.1F;
  Explorer explorer{near};
  std::array robots{scout(0, map, {2, 10})};
  robots[0].body.shape.width_m = robots[0].body.shape.length_m = 0.10F;
  const Order order = explorer.next(0, robots, map, Time{});
  REQUIRE(order.kind == Kind::drive);
  CHECK(order.set_point.distance > 3);
}

TEST_CASE("explorer: a corner nearer than 3 cm is passed by, and one that is farther is not") {
  // A corridor three cells wide, of which a robot fits the middle, and one upwards from its end. Where the
  // robot stands, a cell before the bend, only the cell across the corner is straight ahead.
  std::vector<std::string> rows(27, "#####...#");
  rows.insert(rows.end(), {"#.......#", "#.......#", "#.......#", "#########"});
  const auto first = [&rows](float cell_m) {
    const Map map = map_of(rows, cell_m);
    ExplorerOptions near = options();
    near.view_m = 0.1F;
    Explorer explorer{near};
    const std::array robots{scout(0, map, {5, 2})};
    const Order order = explorer.next(0, robots, map, Time{});
    REQUIRE(order.kind == Kind::drive);
    return order.set_point;
  };
  // The cell across the corner is 2.83 cm away: it drives to the goal, 2 cm aside and 48 cm up.
  CHECK(first(0.02F) == SetPoint{88, 48});
  // 3.54 cm away.
  CHECK(first(0.025F) == SetPoint{45, 3});
}

TEST_CASE("explorer: a border is looked at from as far as it may be, and then from nearer by") {
  const Map map = map_of({"########", "#.......", "########"}, 0.125F);  // lengths that a float holds exactly
  ExplorerOptions near = options();
  near.view_m = 0.25F;
  near.arrive_m = 0.125F;
  Explorer explorer{near};
  std::array robots{scout(0, map, {1, 1})};
  CHECK(explorer.next(0, robots, map, Time{}).kind == Kind::drive);
  REQUIRE(explorer.goal(0));
  CHECK(*explorer.goal(0) == middle_of(map, {5, 1}));
  // As near as it has to come.
  robots[0] = scout(0, map, {4, 1});
  const Order look = explorer.next(0, robots, map, Time{});
  REQUIRE(look.kind == Kind::look);
  // The second time from half as far.
  CHECK(explorer.next(0, robots, map, look.until).kind == Kind::drive);
  REQUIRE(explorer.goal(0));
  CHECK(*explorer.goal(0) == middle_of(map, {7, 1}));
}

TEST_CASE("explorer: where the map shows something a robot sees nothing, and goes where it does") {
  const Map map = map_of({"#######", "#.#....", "#######"});
  Explorer explorer{options()};
  const std::array robots{scout(0, map, {2, 1})};
  const Order order = explorer.next(0, robots, map, Time{});
  CHECK(order.kind == Kind::drive);
  CHECK(order.set_point.angle == 0);
  REQUIRE(explorer.goal(0));
  CHECK(*explorer.goal(0) == middle_of(map, {3, 1}));
}

TEST_CASE("explorer: it looks as long as the border is one, on whichever side, and no longer") {
  const Map closed = map_of({"#####", "#...#", "#...#", "#...#", "#####"});
  for (const auto& rows :
       std::vector<std::vector<std::string>>{{"#####", "#...#", "#... ", "#...#", "#####"},
                                             {"#####", "#...#", " ...#", "#...#", "#####"},
                                             {"## ##", "#...#", "#...#", "#...#", "#####"},
                                             {"#####", "#...#", "#...#", "#...#", "## ##"}}) {
    const Map map = map_of(rows);
    Explorer explorer{options()};
    const std::array robots{scout(0, map, {2, 2})};
    const Order order = explorer.next(0, robots, map, Time{1s});
    CHECK(order.kind == Kind::look);
    CHECK(order.until == Time{1s} + options().look);
    CHECK(explorer.next(0, robots, map, order.until - 1ns).kind == Kind::look);
    CHECK(explorer.next(0, robots, closed, order.until - 1ns).kind == Kind::done);
    CHECK(explorer.counters().reached == 1);
  }
}

TEST_CASE("explorer: what is left of the border") {
  CHECK(Left{}.known() == 0.0);
  CHECK_FALSE(Left{}.is_known());
  CHECK(Left{10, 1, 1, 3}.known() == Approx(0.5));
  // All free cells of the first and last line are at the edge, and so are those in between.
  const Explorer explorer{options()};
  CHECK(explorer.left(map_of({"...", "...", "..."})).edge == 8);
  CHECK(explorer.left(map_of({"#.#", "...", "#.#"})).edge == 4);
}

TEST_CASE("explorer: a corridor is as wide as the robot and its margin, or no way leads through it") {
  const std::string wall(40, '#');
  const Map map = map_of({wall, "#" + std::string(39, '.'), wall});
  const std::array robots{scout(0, map, {1, 1})};
  Explorer narrow{options()};
  CHECK(narrow.next(0, robots, map, Time{1s}).kind == Kind::drive);
  ExplorerOptions wide = options();
  wide.margin_m = 0.2F;
  Explorer careful{wide};
  CHECK(careful.next(0, robots, map, Time{1s}).kind != Kind::drive);
}

TEST_CASE("explorer: where a robot is that has carried out a set point") {
  const Point end = end_of({1.0F, 2.0F, ocm::motion::pi / 2}, {90, 50});
  CHECK(end.x_m == Approx(0.5F));
  CHECK(end.y_m == Approx(2.0F));
  const Point other = end_of({1.0F, 2.0F, 0.0F}, {-30, 100});
  CHECK(other.x_m == Approx(1.0F + 0.8660254F));
  CHECK(other.y_m == Approx(1.5F));
}

TEST_CASE("explorer: a place is known when at most 10 % are not visited, and at most 25 % not seen") {
  struct Case {
    Left left;
    bool not_visited, is_known;
  };
  for (const Case& each : {Case{{0, 0, 0, 0}, false, false}, Case{{100, 0, 0, 0}, false, true},
                           Case{{100, 10, 0, 25}, false, true}, Case{{100, 0, 10, 25}, false, true},
                           Case{{100, 5, 6, 0}, true, false}, Case{{100, 11, 0, 0}, true, false},
                           Case{{100, 0, 11, 0}, true, false}, Case{{100, 0, 0, 26}, false, false},
                           Case{{40, 4, 0, 10}, false, true}, Case{{40, 5, 0, 10}, true, false},
                           Case{{40, 4, 0, 11}, false, false}}) {
    CAPTURE(each.left.edge, each.left.out_of_range, each.left.bad_link, each.left.unseen);
    CHECK(each.left.not_visited() == each.not_visited);
    CHECK(each.left.is_known() == each.is_known);
  }
}

TEST_CASE("explorer: a hole counts from its least size on, however it lies, at the border of the map, too") {
  // Unknown cells in an angle, in all four ways of turning it, with free ones around.
  for (const auto& rows : std::vector<std::vector<std::string>>{{".....", ". ...", ".  ..", "....."},
                                                                {".....", ".  ..", ". ...", "....."},
                                                                {".....", ".  ..", "..  .", "....."},
                                                                {".....", "..  .", ".  ..", "....."}}) {
    std::vector<std::string> walled{"#######"};
    std::size_t cells = 0;
    for (const std::string& row : rows) {
      walled.push_back("#" + row + "#");
      for (const char c : row) cells += c == ' ' ? 1 : 0;
    }
    walled.push_back("#######");
    const Map map = map_of(walled);
    CHECK(frontiers(map, cells).size() >= 5);
    CHECK(frontiers(map, cells + 1).empty());
  }
  // Without room around what is drawn: all of it is at the edge, and a border.
  const Map tight = map_of({"...", "...", "..."}, 0.10F, 9);
  REQUIRE(tight.box() == Box{{0, 0}, {2, 2}});
  CHECK(frontiers(tight, 1).size() == 8);
  const Explorer explorer{options()};
  CHECK(explorer.left(tight).edge == 8);
  CHECK(explorer.left(tight).unseen == 8);
  // Around a single cell there are eight.
  const Map one = map_of({"."}, 0.10F, 1);
  REQUIRE(one.box() == Box{{0, 0}, {0, 0}});
  CHECK(frontiers(one, 8).size() == 1);
  CHECK(frontiers(one, 9).empty());
}

TEST_CASE("explorer: goals are looked for in all of a map, be it wide or tall") {
  for (const bool tall : {false, true}) {
    CAPTURE(tall);
    const std::vector<std::string> rows(tall ? 11U : 1U, tall ? "." : "...........");
    const Map map = map_of(rows, 0.10F, 11);  // without room around it
    REQUIRE(map.box() == (tall ? Box{{0, 0}, {0, 10}} : Box{{0, 0}, {10, 0}}));
    ExplorerOptions near = options();
    near.view_m = 0.25F;
    near.look_m = 1.0F;
    Explorer explorer{near};
    const std::array robots{scout(0, map, {0, 0})};
    // Here it sees three cells of the border, two cells on five of them: 5 / 1.2 is more than 3 / 1.
    CHECK(explorer.next(0, robots, map, Time{}).kind == Kind::drive);
    REQUIRE(explorer.goal(0));
    const Point goal = *explorer.goal(0);
    CHECK((tall ? goal.y_m : goal.x_m) == Approx(0.25F));
    CHECK((tall ? goal.x_m : goal.y_m) == Approx(0.05F));
  }
}

TEST_CASE("explorer: what is left is counted by where it is") {
  const Map map = map_of({"############", "#..........", "############"});
  ExplorerOptions at = options();
  at.home = {0.15F, 0.15F};
  CHECK(Explorer{at}.left(map).unseen == 1);
  at.range_m = 0.5F;  // the border is 90 cm from home
  const Left left = Explorer{at}.left(map);
  CHECK((left.out_of_range == 1 && left.unseen == 0 && left.bad_link == 0));
  CHECK(left.edge == 10);
  CHECK(left.known() == Approx(0.9));
  at.range_m = 0.95F;
  CHECK(Explorer{at}.left(map).unseen == 1);
}

TEST_CASE("explorer: a border exactly as far as the range is within it, and may be driven to") {
  const Map map = map_of({"######", "#.....", "######"}, 0.125F);  // lengths that a float holds exactly
  ExplorerOptions at = options();
  at.home = middle_of(map, {1, 1});
  at.view_m = 0.01F;
  at.range_m = 0.5F;  // so far is the border
  Explorer explorer{at};
  const Left left = explorer.left(map);
  CHECK((left.out_of_range == 0 && left.bad_link == 0 && left.unseen == 1));
  std::array robots{scout(0, map, {1, 1})};
  CHECK(explorer.next(0, robots, map, Time{}).kind == Kind::drive);
  REQUIRE(explorer.goal(0));
  CHECK(*explorer.goal(0) == middle_of(map, {5, 1}));
  // A range that is left of a bad link ends there, too.
  at.range_m = ExplorerOptions{}.range_m;
  Explorer called{at};
  robots[0] = scout(0, map, {5, 1});
  robots[0].call_back = true;
  (void)called.next(0, robots, map, Time{});
  REQUIRE(called.range_m() == 0.5F);
  const Left behind = called.left(map);
  CHECK((behind.out_of_range == 0 && behind.bad_link == 0 && behind.unseen == 1));
  // With home a cell farther away it is beyond.
  at.home = middle_of(map, {0, 1});
  const Left beyond = [&] {
    Explorer other{at};
    (void)other.next(0, robots, map, Time{});
    CHECK(other.range_m() == 0.5F);
    return other.left(map);
  }();
  CHECK((beyond.out_of_range == 0 && beyond.bad_link == 1 && beyond.unseen == 0));
}

TEST_CASE("explorer: as it is delivered, a border is looked at from 45 cm, in pieces of 60 cm at most") {
  const std::string wall(40, '#');
  std::vector<std::string> rows(7, "#" + std::string(39, '.'));  // cells of 10 cm: 70 cm wide, 3.9 m long
  rows.insert(rows.begin(), wall);
  rows.push_back(wall);
  const Map map = map_of(rows);
  Explorer explorer;
  std::array robots{scout(0, map, {3, 4})};
  robots[0].body.shape = Shape{};
  Order order;
  int pieces = 0;
  const Time start{1s};
  for (; pieces < 20; ++pieces) {
    order = explorer.next(0, robots, map, start);
    if (order.kind != Kind::drive) break;
    CHECK(order.set_point.distance <= 60);
    Pose& pose = robots[0].body.pose;
    const Point to = end_of(pose, order.set_point);
    pose = {to.x_m, to.y_m,
            ocm::motion::wrap(pose.heading_rad + ocm::motion::radians(order.set_point.angle))};
    REQUIRE(explorer.goal(0));
    // The last cells are at 3.95 m; seen are at least three of them.
    CHECK(3.95F - explorer.goal(0)->x_m <= 0.45F);
    CHECK(3.95F - explorer.goal(0)->x_m > 0.2F);
  }
  CHECK(pieces >= 6);
  CHECK(order.kind == Kind::look);
  CHECK(explorer.counters().goals == 1);
  CHECK(explorer.counters().pieces == static_cast<unsigned>(pieces));
  CHECK(distance_m(place(robots[0].body.pose), *explorer.goal(0)) <= 0.06F);
  // Before a whole turn of the tower it does not go on.
  CHECK(order.until >= start + 3s);
  CHECK(order.until <= start + 6s);
}

TEST_CASE("explorer: two or fewer border cells, or a hole of 15, are no goal as it is delivered") {
  const auto first = [](const std::vector<std::string>& rows) {
    const Map map = map_of(rows);
    Explorer explorer;
    std::array robots{scout(0, map, {1, 1})};
    robots[0].body.shape.width_m = robots[0].body.shape.length_m = 0.02F;
    return explorer.next(0, robots, map, Time{}).kind;
  };
  const std::string wall(8, '#');
  const auto open = [&](int lines) {
    std::vector<std::string> rows{wall};
    for (int i = 0; i < 5; ++i) rows.push_back(i < lines ? "#......." : "#......#");
    rows.push_back(wall);
    return rows;
  };
  CHECK(first(open(2)) == Kind::done);
  CHECK(first(open(3)) != Kind::done);
  const auto hole = [&](const std::string& last) {
    std::vector<std::string> rows{"########"};
    rows.insert(rows.end(), {"#....  #", "#....  #", "#....  #", "#....  #", "#....  #", "#....  #",
                             "#....  #", "#...." + last + "#"});
    rows.push_back("########");
    rows.push_back("########");
    return rows;
  };
  CHECK(first(hole("# ")) == Kind::done);  // 15
  CHECK(first(hole("  ")) != Kind::done);  // 16
}

TEST_CASE("explorer: of two borders the one that shows more for its way") {
  // Standing in a corridor of one cell: two border cells ahead to the left, or more to the right.
  const auto goes_right = [](int left_cells, int left_way, int right_cells, int right_way) {
    const int width = left_way + right_way + 5;
    std::vector<std::string> rows(9, std::string(static_cast<std::size_t>(width), '#'));
    for (int x = 1; x + 1 < width; ++x) rows[4][static_cast<std::size_t>(x)] = '.';
    for (int i = 0; i < left_cells; ++i)
      rows[static_cast<std::size_t>(4 - left_cells / 2 + i)]
          [1] = '.',
       rows[static_cast<std::size_t>(4 - left_cells / 2 + i)][0] = ' ';
    for (int i = 0; i < right_cells; ++i) {
      std::string& row = rows[static_cast<std::size_t>(4 - right_cells / 2 + i)];
      row[row.size() - 2] = '.', row[row.size() - 1] = ' ';
    }
    const Map map = map_of(rows);
    ExplorerOptions near = options();
    near.view_m = 0.25F;
    Explorer explorer{near};
    const std::array robots{scout(0, map, {2 + left_way, 4})};
    const Order order = explorer.next(0, robots, map, Time{});
    REQUIRE(order.kind == Kind::drive);
    return order.set_point.angle == 0;
  };
  CHECK_FALSE(goes_right(3, 6, 3, 12));
  CHECK(goes_right(3, 12, 3, 6));
  CHECK(goes_right(1, 8, 5, 12));
  CHECK_FALSE(goes_right(5, 12, 1, 8));
}

TEST_CASE("explorer: a robot that only creeps gives its goal up after so many pieces") {
  const Map map = map_of({std::string(60, '#'), "#" + std::string(59, '.'), std::string(60, '#')});
  ExplorerOptions few = options();
  few.most_pieces = 5;
  Explorer explorer{few};
  std::array robots{scout(0, map, {1, 1})};
  for (unsigned i = 1; i <= 5; ++i) {
    CHECK(explorer.next(0, robots, map, Time{}).kind == Kind::drive);
    CHECK(explorer.counters() == ExplorerCounters{.goals = 1, .pieces = i});
    robots[0].body.pose.x_m += 0.03F;
  }
  // The next one is to the same border: a second try.
  CHECK(explorer.next(0, robots, map, Time{}).kind == Kind::drive);
  CHECK(explorer.counters() == ExplorerCounters{.goals = 2, .stalled = 1, .pieces = 6});
  // A step of less than 2 cm is none; two of them in a row, and it is given up. One of more, and it counts
  // from the beginning.
  explorer.forget(0);
  Explorer again{options()};
  for (const float step : {0.0F, 0.01F, 0.025F, 0.015F}) {
    robots[0].body.pose.x_m += step;
    CHECK(again.next(0, robots, map, Time{}).kind == Kind::drive);
    CHECK(again.counters().stalled == 0);
  }
  robots[0].body.pose.x_m += 0.019F;
  (void)again.next(0, robots, map, Time{});
  CHECK(again.counters().stalled == 1);
}

TEST_CASE("explorer: what stopped it is remembered, and the next way leads around it") {
  const Map map = map_of(std::vector<std::string>(21, std::string(21, '.')));
  ExplorerOptions near = options();
  near.view_m = 0.15F;
  Explorer explorer{near};
  std::array robots{scout(0, map, {10, 10})};
  Order order;
  for (int i = 0; i < 3; ++i) order = explorer.next(0, robots, map, Time{});
  CHECK(explorer.counters().stalled == 1);
  REQUIRE(order.kind == Kind::drive);
  // Whatever is ahead of it is 2 cm before its body: no way leads through there now.
  const Point stop = ocm::motion::to_world(robots[0].body.pose, {0.03F, 0.0F});
  const Point to = end_of(robots[0].body.pose, order.set_point);
  CHECK(distance_m(Wall{place(robots[0].body.pose), to}, stop) > 0.02F);
}

TEST_CASE("explorer: what stopped it the last 64 times is remembered, and what did before is not") {
  // A dead end of five cells, open to a hall. What stops a robot in the middle of it is in the way of one at
  // its end.
  std::vector<std::string> rows(21, "######" + std::string(21, '.'));
  rows[10] = "#" + std::string(26, '.');
  const Map map = map_of(rows, 0.10F, 2000);  // without room around it
  ExplorerOptions near = options();
  near.view_m = 0.15F;
  near.most_tries = 255;
  Explorer explorer{near};
  const auto stop_at = [&](Cell at, unsigned times) {
    const std::array robots{scout(0, map, at)};
    explorer.forget(0);
    for (int i = 0; i < 1000 && explorer.counters().stalled < times; ++i)
      (void)explorer.next(0, robots, map, Time{});
    REQUIRE(explorer.counters().stalled == times);
  };
  const auto leaves = [&] {
    const std::array robots{scout(0, map, {1, 10})};
    explorer.forget(0);
    return explorer.next(0, robots, map, Time{}).kind == Kind::drive;
  };
  CHECK(leaves());
  stop_at({2, 10}, 1);
  CHECK_FALSE(leaves());
  stop_at({16, 10}, 64);
  CHECK_FALSE(leaves());
  stop_at({16, 10}, 65);
  CHECK(leaves());
}

TEST_CASE(
    "explorer: as it is delivered, goals of two robots are 60 cm apart, and not much more where there is no "
    "room") {
  std::vector<std::string> rows(9, std::string(9, '.'));  // 90 by 90 cm
  const Map map = map_of(rows);
  Explorer explorer;
  std::array robots{scout(0, map, {2, 4}), scout(1, map, {6, 4})};
  (void)explorer.next(0, robots, map, Time{});
  REQUIRE(explorer.goal(0));
  (void)explorer.next(1, robots, map, Time{});
  if (explorer.goal(1)) CHECK(distance_m(*explorer.goal(0), *explorer.goal(1)) >= 0.6F);
  // Where there is room, it gets one.
  const Map hall = map_of(std::vector<std::string>(9, std::string(24, '.')));
  Explorer both;
  std::array apart{scout(0, hall, {9, 4}), scout(1, hall, {14, 4})};
  (void)both.next(0, apart, hall, Time{});
  (void)both.next(1, apart, hall, Time{});
  REQUIRE(both.goal(0));
  REQUIRE(both.goal(1));
  CHECK(distance_m(*both.goal(0), *both.goal(1)) >= 0.6F);
  CHECK(distance_m(*both.goal(0), *both.goal(1)) < 1.6F);
}

TEST_CASE(
    "explorer: called back, it goes home in pieces, waits when it does not come nearer, and shrinks the "
    "range once a call") {
  const Map map = map_of({"####################", "#..................", "####################"});
  ExplorerOptions at = options();
  at.home = {0.15F, 0.15F};
  Explorer explorer{at};
  std::array robots{scout(0, map, {12, 1})};
  robots[0].call_back = true;
  std::vector<Kind> kinds;
  for (int i = 0; i < 4; ++i) kinds.push_back(explorer.next(0, robots, map, Time{}).kind);
  CHECK(kinds == std::vector{Kind::drive, Kind::drive, Kind::wait, Kind::wait});
  CHECK(explorer.range_m() == Approx(0.9F));  // 20 cm less than where it was called
  CHECK(explorer.counters() == ExplorerCounters{.pieces = 2, .calls = 1});
  // Well again it is sent again, and a second call is one more; not nearer than half a metre.
  robots[0].call_back = false;
  CHECK(explorer.next(0, robots, map, Time{}).kind == Kind::drive);
  CHECK(explorer.counters().grown > 0);
  robots[0] = scout(0, map, {5, 1});
  robots[0].call_back = true;
  (void)explorer.next(0, robots, map, Time{});
  CHECK(explorer.counters().calls == 2);
  CHECK(explorer.range_m() == Approx(0.5F));
  // It grows by half a metre each time.
  const auto grown = explorer.counters().grown;
  robots[0].call_back = false;
  (void)explorer.next(0, robots, map, Time{});
  const auto times = explorer.counters().grown - grown;
  CHECK(times > 0);
  CHECK(explorer.range_m() == Approx(0.5F + 0.5F * static_cast<float>(times)));
}

TEST_CASE("explorer: who is in a tall map goes home as well as in a wide one") {
  std::vector<std::string> rows{"#.#"};
  for (int i = 0; i < 18; ++i) rows.emplace_back("#.#");
  rows.emplace_back("###");
  const Map map = map_of(rows);
  ExplorerOptions at = options();
  at.home = {0.15F, 0.15F};
  Explorer explorer{at};
  std::array robots{scout(0, map, {1, 12})};
  robots[0].call_back = true;
  const Order order = explorer.next(0, robots, map, Time{});
  REQUIRE(order.kind == Kind::drive);
  CHECK(order.set_point.angle == -90);
  CHECK(order.set_point.distance >= 100);
}

TEST_CASE("explorer: home may be anywhere") {
  const Map map = map_of({"####################", "#..................", "####################"});
  ExplorerOptions at = options();
  at.home = middle_of(map, {5, 1});
  Explorer explorer{at};
  std::array robots{scout(0, map, {15, 1})};
  robots[0].call_back = true;
  const Order order = explorer.next(0, robots, map, Time{});
  REQUIRE(order.kind == Kind::drive);
  CHECK(std::abs(order.set_point.angle) == 180);
  CHECK(order.set_point.distance >= 99);
  CHECK(order.set_point.distance <= 100);
}

TEST_CASE("explorer: a robot without a goal waits while another has one, and is done when none has") {
  const Map map = map_of({"#####", "#...", "#...#", "#####"});
  Explorer explorer{options()};
  std::vector<Scout> robots{scout(0, map, {1, 1}), scout(1, map, {1, 2})};
  CHECK(explorer.next(0, robots, map, Time{}).kind != Kind::done);
  CHECK(explorer.next(1, robots, map, Time{}).kind == Kind::wait);
  CHECK(explorer.counters().blocked == 1);
  robots[0].lost = true;
  CHECK(explorer.next(1, robots, map, Time{}).kind != Kind::wait);
  CHECK(explorer.counters().blocked == 1);
}

TEST_CASE("explorer: nothing to do") {
  const Map closed = map_of({"####", "#..#", "####"});
  Explorer explorer{options()};
  std::array robots{scout(0, closed, {1, 1})};
  CHECK(explorer.next(0, robots, closed, Time{}).kind == Kind::done);
  CHECK(explorer.next(7, robots, closed, Time{}).kind == Kind::done);
  robots[0].body.pose = {NAN, 0, 0};
  CHECK(explorer.next(0, robots, closed, Time{}).kind == Kind::done);
  // A border behind a door that is too narrow.
  const Map map = map_of({"#######", "#..#...", "#......", "#..#...", "#######"});
  std::array wide{scout(0, map, {1, 2})};
  wide[0].body.shape.width_m = wide[0].body.shape.length_m = 0.12F;
  Explorer second{options()};
  ExplorerOptions near = options();
  near.view_m = 0.2F;
  CHECK(Explorer{near}.next(0, wide, map, Time{}).kind == Kind::done);
}

TEST_CASE("explorer: a robot that cannot get there gives the goal up") {
  const Map map = map_of({"##########", "#.........", "##########"});
  Explorer explorer{options()};
  std::array robots{scout(0, map, {1, 1})};
  Order order{Kind::drive, {}, {}};
  int orders = 0;
  for (; order.kind != Kind::done && orders < 200; ++orders)
    order = explorer.next(0, robots, map, Time{orders * 10s});
  CHECK(order.kind == Kind::done);
  CHECK(explorer.counters().stalled > 0);
  CHECK(explorer.counters().reached == 0);
}

TEST_CASE("explorer: two robots get different goals") {
  const Map map = map_of({"...................",  //
                          "...................",  //
                          "..................."});
  ExplorerOptions wide = options();
  wide.apart_m = 0.7F;
  wide.view_m = 0.2F;
  Explorer explorer{wide};
  const std::array robots{scout(0, map, {8, 1}), scout(1, map, {10, 1})};
  const Order first = explorer.next(0, robots, map, Time{});
  const Order second = explorer.next(1, robots, map, Time{});
  REQUIRE(explorer.goal(0));
  REQUIRE(explorer.goal(1));
  CHECK(distance_m(*explorer.goal(0), *explorer.goal(1)) >= wide.apart_m);
  CHECK(first.kind != Kind::done);
  CHECK(second.kind != Kind::done);
}

TEST_CASE("explorer: no way leads past a robot in a corridor; once it has gone, it does") {
  const Map map = map_of({"##########", "#.........", "##########"});
  Explorer explorer{options()};
  std::vector<Scout> robots{scout(0, map, {1, 1}), scout(1, map, {4, 1})};
  ExplorerOptions near = options();
  near.view_m = 0.2F;
  Explorer blocked{near};
  REQUIRE(blocked.next(1, robots, map, Time{}).kind == Kind::drive);
  CHECK(blocked.next(0, robots, map, Time{}).kind != Kind::drive);
  robots.pop_back();
  blocked.forget(1);
  CHECK(blocked.next(0, robots, map, Time{}).kind == Kind::drive);
}

TEST_CASE("explorer: no way crosses the one that another robot is about to take, unless that one is lost") {
  // Two corridors that cross: one upwards at 10, one to the right at 5, open at their ends.
  std::vector<std::string> rows(14, std::string(31, '#'));
  for (std::size_t row = 0; row < 13; ++row) rows[row][10] = '.';
  for (std::size_t column = 1; column < 31; ++column) rows[8][column] = '.';
  const Map map = map_of(rows);
  ExplorerOptions near = options();
  near.view_m = 0.2F;
  Explorer explorer{near};
  std::array robots{scout(0, map, {1, 5}), scout(1, map, {10, 1})};
  REQUIRE(explorer.next(1, robots, map, Time{}).kind == Kind::drive);
  REQUIRE(explorer.goal(1));
  CHECK(*explorer.goal(1) == middle_of(map, {10, 12}));
  // It stands aside still, but will come.
  CHECK(explorer.next(0, robots, map, Time{}).kind == Kind::wait);
  CHECK(explorer.counters().blocked == 1);
  robots[1].lost = true;
  CHECK(explorer.next(0, robots, map, Time{}).kind == Kind::drive);
  CHECK(explorer.counters().blocked == 1);
}

TEST_CASE("explorer: a robot that is called back goes home, and no goal is so far away again") {
  const Map map = map_of({"####################", "#..................", "####################"});
  ExplorerOptions at = options();
  at.home = {0.15F, 0.15F};
  Explorer explorer{at};
  std::array robots{scout(0, map, {12, 1})};
  REQUIRE(explorer.next(0, robots, map, Time{}).kind == Kind::drive);
  robots[0].call_back = robots[0].too_far = true;
  const Order back = explorer.next(0, robots, map, Time{});
  REQUIRE(back.kind == Kind::drive);
  CHECK(std::abs(back.set_point.angle) == 180);
  CHECK(back.set_point.distance >= 100);
  CHECK(explorer.range_m() == Approx(0.90F).margin(0.02));
  CHECK(explorer.counters().calls == 1);
  // At home it waits for its link to be well again; then there is nothing within reach.
  robots[0] = scout(0, map, {1, 1});
  robots[0].call_back = true;
  CHECK(explorer.next(0, robots, map, Time{}).kind == Kind::wait);
  robots[0].call_back = robots[0].too_far = false;
  CHECK(explorer.next(0, robots, map, Time{}).kind == Kind::done);
  CHECK(explorer.left(map).out_of_range > 0);
  CHECK(explorer.left(map).known() < 1);
}

TEST_CASE("explorer: behind a bad link the range grows again, until that has led to nothing several times") {
  const Map map = map_of({"####################", "#..................", "####################"});
  ExplorerOptions at = options();
  at.home = {0.15F, 0.15F};
  Explorer explorer{at};
  std::array robots{scout(0, map, {12, 1})};
  REQUIRE(explorer.next(0, robots, map, Time{}).kind == Kind::drive);
  unsigned calls = 0;
  for (; calls < 50; ++calls) {
    robots[0] = scout(0, map, {12, 1});
    robots[0].call_back = true;
    (void)explorer.next(0, robots, map, Time{});
    CHECK(explorer.range_m() < 1.0F);
    robots[0] = scout(0, map, {1, 1});
    if (explorer.next(0, robots, map, Time{}).kind == Kind::done) break;
    CHECK(explorer.range_m() > 1.5F);
  }
  CHECK(calls >= 1);
  CHECK(calls <= at.most_fruitless);
  CHECK(explorer.counters().grown == at.most_fruitless);
  const auto left = explorer.left(map);
  CHECK(left.bad_link > 0);
  CHECK(left.out_of_range == 0);
  CHECK(left.known() < 1);
}

TEST_CASE("explorer: behind a goal that was reached the range grows again as often as before") {
  const Map map = map_of({"####################", "#..................", "####################"});
  ExplorerOptions at = options();
  at.home = {0.15F, 0.15F};
  at.most_fruitless = 1;
  at.grow_m = 10.0F;
  Explorer explorer{at};
  std::array robots{scout(0, map, {12, 1})};
  const auto called_and_sent = [&] {
    robots[0] = scout(0, map, {12, 1});
    robots[0].call_back = true;
    (void)explorer.next(0, robots, map, Time{});
    CHECK(explorer.range_m() == Approx(0.9F));
    robots[0] = scout(0, map, {1, 1});
    return explorer.next(0, robots, map, Time{}).kind;
  };
  CHECK(called_and_sent() == Kind::drive);
  CHECK(explorer.counters().grown == 1);
  REQUIRE(explorer.goal(0));
  robots[0].body.pose = {explorer.goal(0)->x_m, explorer.goal(0)->y_m, 0.0F};
  const Order look = explorer.next(0, robots, map, Time{});
  REQUIRE(look.kind == Kind::look);
  (void)explorer.next(0, robots, map, look.until);
  REQUIRE(explorer.counters().reached == 1);
  CHECK(called_and_sent() == Kind::drive);
  CHECK(explorer.counters().grown == 2);
  // That one was not reached.
  CHECK(called_and_sent() == Kind::done);
  CHECK(explorer.counters().grown == 2);
}

TEST_CASE("explorer: a goal to which there is no way any more is given up, and counted") {
  const Map open = map_of({"##########", "#.........", "##########"});
  const Map shut = map_of({"##########", "#..#......", "##########"});
  Explorer explorer{options()};
  std::array robots{scout(0, open, {1, 1})};
  CHECK(explorer.next(0, robots, open, Time{}).kind == Kind::drive);
  robots[0] = scout(0, open, {2, 1});
  CHECK(explorer.next(0, robots, shut, Time{}).kind == Kind::done);
  CHECK_FALSE(explorer.goal(0));
  CHECK(explorer.counters() == ExplorerCounters{.goals = 1, .cut_off = 1, .pieces = 1});
}

TEST_CASE("explorer: a lost robot does nothing, and is in the way") {
  const Map map = map_of({"##########", "#.........", "##########"});
  ExplorerOptions near = options();
  near.view_m = 0.2F;
  Explorer explorer{near};
  std::vector<Scout> robots{scout(0, map, {1, 1}), scout(1, map, {4, 1})};
  robots[1].lost = true;
  CHECK(explorer.next(1, robots, map, Time{}).kind == Kind::done);
  CHECK(explorer.next(0, robots, map, Time{}).kind == Kind::done);
}

TEST_CASE("explorer: whatever the map: it ends, and no piece leads through something") {
  Random random{5};
  int pieces = 0;
  const int runs = ocm::test::explored(10, 2);
  for (int run = 0; run < runs; ++run) {
    CAPTURE(run);
    std::vector<std::string> rows(20, std::string(25, '.'));
    for (auto& row : rows)
      for (char& c : row) {
        const unsigned which = random.below(25);
        if (which < 2) c = '#';
        if (which == 2) c = ' ';
      }
    const Map map = map_of(rows);
    Explorer explorer{options()};
    std::vector<Scout> robots;
    for (std::uint8_t i = 0; i < 2; ++i) {
      const Cell c{random.within(0, 24), random.within(0, 19)};
      if (map.state(c) == CellState::free) robots.push_back(scout(i, map, c));
    }
    Time now{};
    std::size_t idle = 0;
    int orders = 0;
    for (; idle < robots.size() && orders < 20'000; ++orders) {
      now += 1s;
      idle = 0;
      for (Scout& robot : robots) {
        const Order order = explorer.next(robot.robot, robots, map, now);
        if (order.kind == Kind::done || order.kind == Kind::wait) ++idle;
        if (order.kind != Kind::drive) continue;
        ++pieces;
        Pose& pose = robot.body.pose;
        const Point from = place(pose), to = end_of(pose, order.set_point);
        const float heading = pose.heading_rad + ocm::motion::radians(order.set_point.angle);
        for_each_cell(map.raster(), from, to, [&](Cell c) {
          REQUIRE(map.state(c) != CellState::occupied);
          return true;
        });
        // It may stop anywhere on the way.
        const float part = static_cast<float>(random.below(11)) / 10.0F;
        pose = {from.x_m + part * (to.x_m - from.x_m), from.y_m + part * (to.y_m - from.y_m),
                ocm::motion::wrap(heading)};
      }
    }
    REQUIRE(orders < 20'000);
  }
  CHECK(pieces > 20 * runs);
}

}  // namespace cognitive_explorer_test
