#include "ocm/cognitive/routes.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"
#include "unit/cognitive/testing/drawing.hpp"

namespace cognitive_routes_test {

using namespace ocm::cognitive;
using ocm::motion::Point;
using ocm::test::map_of;
using ocm::test::middle_of;
using ocm::test::Random;

// Cells of 10 cm. The lower left character is cell 0, 0.
const std::vector<std::string> hall{"##########",  //
                                    "#........#",  //
                                    "#.####...#",  //
                                    "#....#...#",  //
                                    "#....#...#",  //
                                    "##########"};

TEST_CASE("routes: clearance by hand") {
  const Map map = map_of(hall);
  const Terrain terrain{map};
  CHECK(terrain.state({1, 4}) == CellState::free);
  CHECK(terrain.state({2, 3}) == CellState::occupied);
  // One cell from the next: half a cell to its border.
  CHECK(terrain.clearance_m({1, 1}) == Approx(0.05F));
  CHECK(terrain.clearance_m({0, 0}) == 0.0F);
  // 7, 3: two cells from 9, 3 and from 5, 3.
  CHECK(terrain.clearance_m({7, 3}) == Approx(0.15F));
  CHECK(terrain.clearance_m({100, 100}) == 0.0F);
  CHECK(terrain.passable({7, 3}, 0.15F));
  CHECK_FALSE(terrain.passable({7, 3}, 0.16F));
  CHECK_FALSE(terrain.passable({0, 0}, 0.0F));
}

TEST_CASE("routes: clearance against a search over all cells") {
  Random random{1};
  for (int run = 0; run < 30; ++run) {
    const int width = 3 + static_cast<int>(random.below(20)), height = 3 + static_cast<int>(random.below(20));
    std::vector<std::string> rows(static_cast<std::size_t>(height),
                                  std::string(static_cast<std::size_t>(width), '.'));
    const unsigned sparse = 2 + random.below(30);
    for (auto& row : rows)
      for (char& c : row)
        if (random.below(sparse) == 0) c = '#';
    const Map map = map_of(rows);
    const Terrain terrain{map};
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        double best = 1e30;
        for (int b = 0; b < height; ++b)
          for (int a = 0; a < width; ++a)
            if (map.state({a, b}) == CellState::occupied) best = std::min(best, std::hypot(a - x, b - y));
        const float clearance = terrain.clearance_m({x, y});
        if (best > 1e20)
          REQUIRE(clearance > 1000.0F);
        else
          REQUIRE(clearance == Approx(best == 0 ? 0.0 : (best - 0.5) * 0.1).margin(1e-4));
      }
  }
}

TEST_CASE("routes: around a wall, by hand") {
  const Map map = map_of(hall);
  const Terrain terrain{map};
  const Routes routes{terrain, middle_of(map, {3, 1}), 0.04F};
  REQUIRE(routes.reaches({7, 1}));
  const auto way = routes.way_to({7, 1});
  REQUIRE(way.size() >= 4);
  CHECK(way.front() == middle_of(map, {3, 1}));
  CHECK(way.back() == middle_of(map, {7, 1}));
  // It must pass the gap at the upper left.
  CHECK(routes.cost({7, 1}) > 1.0F);
  // A robot that is too wide for the gap of one cell has no way.
  const Routes wide{terrain, middle_of(map, {7, 3}), 0.06F};
  CHECK_FALSE(wide.reaches({3, 1}));
  CHECK(wide.way_to({3, 1}).empty());
  CHECK(wide.reaches({7, 2}));
}

TEST_CASE("routes: what a way costs, by hand") {
  // In a corridor half a cell is free to each side: 5 cm. At 10 cm beyond its circle a metre costs one, with
  // none three.
  const Map corridor = map_of({"########", "#......#", "########"});
  const auto along = [&](float radius_m) {
    return Routes(Terrain{corridor}, middle_of(corridor, {1, 1}), radius_m).cost({6, 1});
  };
  CHECK(along(0.0F) == Approx(0.5F * 2.0F));
  CHECK(along(0.025F) == Approx(0.5F * 2.5F));
  CHECK(along(0.05F) == Approx(0.5F * 3.0F));
  const Map field = map_of(std::vector<std::string>(11, std::string(11, '.')));
  const Terrain open{field};
  const Routes routes{open, middle_of(field, {5, 5}), 0.05F};
  CHECK(routes.cost({5, 5}) == 0.0F);
  for (const Cell c : {Cell{9, 5}, Cell{1, 5}, Cell{5, 9}, Cell{5, 1}}) CHECK(routes.cost(c) == Approx(0.4F));
  for (const Cell c : {Cell{9, 9}, Cell{1, 9}, Cell{9, 1}, Cell{1, 1}})
    CHECK(routes.cost(c) == Approx(0.4F * 1.4142135F));
  CHECK(routes.cost({8, 6}) == Approx(0.2F + 0.1F * 1.4142135F));
  // A corner is not cut, whichever of both sides is not free, and whatever is there.
  for (const char blocks : {'#', ' '})
    for (const bool above : {false, true}) {
      std::vector<std::string> rows{"...", "...", "..."};
      rows[above ? 0 : 1][above ? 1 : 2] = blocks;  // of the way from 1, 1 to 2, 2
      const Map map = map_of(rows);
      CHECK(Routes(Terrain{map}, middle_of(map, {1, 1}), 0.0F).cost({2, 2}) > 0.19F);
    }
}

TEST_CASE("routes: costs of all cells, against steps that are tried until none is better") {
  Random random{9};
  int reached = 0;
  for (int run = 0; run < 60; ++run) {
    std::vector<std::string> rows(9, std::string(11, '.'));
    for (auto& row : rows)
      for (char& c : row) {
        const unsigned which = random.below(12);
        if (which == 0) c = '#';
        if (which == 1) c = ' ';
      }
    const Map map = map_of(rows, 0.10F, run % 2 == 0 ? 99 : 1 << 20);
    const Terrain terrain{map};
    const Cell start{random.within(0, 10), random.within(0, 8)};
    if (!map.box().has(start)) continue;
    const float radius = static_cast<float>(random.below(4)) * 0.05F;
    const Routes routes{terrain, middle_of(map, start), radius};
    constexpr double none = 1e9;
    double costs[9][11];
    for (auto& line : costs)
      for (double& cost : line) cost = none;
    costs[start.y][start.x] = 0;
    const auto free = [&](int x, int y) { return map.state({x, y}) == CellState::free; };
    for (bool better = true; better;) {
      better = false;
      for (int y = 0; y < 9; ++y)
        for (int x = 0; x < 11; ++x)
          for (int b = std::max(0, y - 1); b <= std::min(8, y + 1); ++b)
            for (int a = std::max(0, x - 1); a <= std::min(10, x + 1); ++a) {
              if ((a == x && b == y) || costs[y][x] == none || !free(a, b) || !free(a, y) || !free(x, b)) {
                // The side cells of a straight step are the two cells themselves: its first one may be
                // anything.
                const bool straight = (a == x) != (b == y);
                if (!straight || costs[y][x] == none || !free(a, b)) continue;
              }
              const double here = terrain.clearance_m({x, y}), there = terrain.clearance_m({a, b});
              if (there < radius && !(here < radius && there > here)) continue;
              const double narrow = std::clamp(1 - (there - radius) / 0.10, 0.0, 1.0);
              const double cost =
                  costs[y][x] + 0.1 * (a != x && b != y ? std::sqrt(2.0) : 1) * (1 + 2 * narrow);
              if (cost >= costs[b][a] - 1e-9) continue;
              costs[b][a] = cost;
              better = true;
            }
    }
    for (int y = 0; y < 9; ++y)
      for (int x = 0; x < 11; ++x) {
        CAPTURE(run, x, y);
        if (costs[y][x] == none)
          REQUIRE_FALSE(routes.reaches({x, y}));
        else
          REQUIRE(routes.cost({x, y}) == Approx(costs[y][x]).margin(1e-4));
        reached += costs[y][x] == none ? 0 : 1;
      }
  }
  CHECK(reached > 500);
}

TEST_CASE("routes: what is seen, what is open, and what is straight, by hand") {
  const Map map = map_of({".......", "...#...", ".......", ".... ..", "......."});
  const Terrain terrain{map};
  const auto at = [&](int x, int y) { return middle_of(map, {x, y}); };
  CHECK(terrain.sees(at(1, 2), at(5, 2)));
  CHECK_FALSE(terrain.sees(at(1, 3), at(5, 3)));
  CHECK(terrain.sees(at(1, 3), at(3, 3)));        // the wall itself
  CHECK_FALSE(terrain.sees(at(3, 3), at(5, 3)));  // but not out of it
  CHECK(terrain.sees(at(1, 1), at(6, 1)));        // nothing that is known hides it
  CHECK_FALSE(terrain.open(at(1, 3), at(5, 3)));
  CHECK_FALSE(terrain.open(at(1, 3), at(3, 3)));
  CHECK(terrain.open(at(3, 3), at(5, 3)));
  CHECK(terrain.open(at(1, 1), at(6, 1)));
  // In line 2 a robot is half a cell below the wall; a wider one that begins closer comes no closer.
  CHECK(terrain.straight(at(0, 2), at(6, 2), 0.05F));
  CHECK_FALSE(terrain.straight(at(0, 2), at(6, 2), 0.06F));
  CHECK(terrain.straight(at(3, 2), at(6, 2), 0.06F));
  CHECK_FALSE(terrain.straight(at(0, 1), at(6, 1), 0.0F));
}

TEST_CASE("routes: others are kept off around each leg, and where they stand") {
  const Map map = map_of(std::vector<std::string>(9, std::string(9, '.')));
  const auto at = [&](int x, int y) { return middle_of(map, {x, y}); };
  const std::vector<Moving> others{{{at(1, 1), at(5, 1), at(5, 5)}, 0.04F}, {{at(1, 7)}, 0.02F}};
  const Terrain terrain{map, others};
  for (const Cell c : {Cell{1, 1}, Cell{3, 1}, Cell{5, 1}, Cell{5, 3}, Cell{5, 5}})
    CHECK(terrain.clearance_m(c) == Approx(-0.04F));
  CHECK(terrain.clearance_m({3, 3}) == Approx(0.16F));
  CHECK(terrain.clearance_m({1, 7}) == Approx(-0.02F));
  CHECK(terrain.clearance_m({8, 8}) == Approx(std::hypot(0.3F, 0.3F) - 0.04F));
  CHECK(Terrain{map, {{Moving{}}}}.clearance_m({1, 1}) > 1000.0F);  // one that is nowhere
}

TEST_CASE("routes: what was not seen is no way") {
  const Map map = map_of({"#####", "#. .#", "#####"});
  const Terrain terrain{map};
  CHECK_FALSE(Routes(terrain, middle_of(map, {1, 1}), 0.0F).reaches({3, 1}));
}

TEST_CASE("routes: a robot that stands too close may leave, but come no closer") {
  const Map map =
      map_of({"#########", "#.......#", "#.......#", "#.......#", "#.......#", "#.......#", "#########"});
  const Terrain terrain{map};
  const Routes routes{terrain, middle_of(map, {1, 3}), 0.14F};
  CHECK(routes.reaches({4, 3}));
  CHECK(routes.reaches({3, 3}));
  CHECK_FALSE(routes.reaches({7, 1}));
}

TEST_CASE("routes: others are kept off, along all of their way") {
  const Map map = map_of({".........", ".........", ".........", ".........", "........."});
  const std::vector<Moving> others{{{middle_of(map, {4, 0}), middle_of(map, {4, 4})}, 0.05F}};
  const Terrain terrain{map, others};
  CHECK(terrain.clearance_m({4, 2}) == Approx(-0.05F));
  CHECK(terrain.clearance_m({6, 2}) == Approx(0.15F));
  CHECK_FALSE(Routes(terrain, middle_of(map, {1, 2}), 0.08F).reaches({7, 2}));
  CHECK(Routes(Terrain{map}, middle_of(map, {1, 2}), 0.08F).reaches({7, 2}));
}

TEST_CASE("routes: from nowhere, to nowhere") {
  const Map map = map_of(hall);
  const Terrain terrain{map};
  CHECK_FALSE(Routes(terrain, {50.0F, 50.0F}, 0.0F).reaches({7, 3}));
  CHECK_FALSE(Routes(terrain, {NAN, 0.0F}, 0.0F).reaches({7, 3}));
  CHECK(Routes(terrain, middle_of(map, {7, 3}), 0.0F).way_to({500, 3}).empty());
  const Map nothing;
  const Terrain blank{nothing};
  CHECK_FALSE(Routes(blank, {0.0F, 0.0F}, 0.1F).reaches({0, 0}));
}

TEST_CASE(
    "routes: whatever the map, no way leads through what is not free, and none is longer than the cells' "
    "own") {
  Random random{2};
  int found = 0;
  for (int run = 0; run < 300; ++run) {
    std::vector<std::string> rows(24, std::string(30, '.'));
    for (auto& row : rows)
      for (char& c : row) {
        const unsigned which = random.below(40);
        if (which < 3) c = '#';
        if (which == 3) c = ' ';
      }
    const Map map = map_of(rows);
    const Terrain terrain{map};
    const Cell start{random.within(0, 29), random.within(0, 23)},
        goal{random.within(0, 29), random.within(0, 23)};
    if (map.state(start) != CellState::free) continue;
    const float radius = static_cast<float>(random.below(3)) * 0.05F;
    const Routes routes{terrain, middle_of(map, start), radius};
    const auto way = routes.way_to(goal);
    REQUIRE(way.empty() != routes.reaches(goal));
    if (way.empty()) continue;
    ++found;
    REQUIRE(way.front() == middle_of(map, start));
    REQUIRE(way.back() == middle_of(map, goal));
    double length = 0;
    for (std::size_t i = 1; i < way.size(); ++i) {
      length += distance_m(way[i - 1], way[i]);
      for_each_cell(map.raster(), way[i - 1], way[i], [&](Cell c) {
        REQUIRE(map.state(c) == CellState::free);
        return true;
      });
    }
    REQUIRE(length <= routes.cost(goal) + 1e-3);
  }
  CHECK(found > 60);
}

}  // namespace cognitive_routes_test
