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

TEST_CASE("explorer: a corner nearer than 3 cm is passed by") {
  // Cells of 2 cm. The robot is closer to the wall than it may come: only the next cell is straight ahead.
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
  const int runs = ocm::test::explored(10);
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
