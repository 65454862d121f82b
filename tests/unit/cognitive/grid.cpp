#include "ocm/cognitive/grid.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"

namespace cognitive_grid_test {

using namespace ocm::cognitive;
using ocm::motion::Point;
using ocm::test::Random;

std::vector<Cell> line(const Raster& raster, Point from, Point to) {
  std::vector<Cell> cells;
  for_each_cell(raster, from, to, [&](Cell c) {
    cells.push_back(c);
    return true;
  });
  return cells;
}

TEST_CASE("grid: boxes by hand") {
  static_assert(Box{}.empty() && Box{}.cells() == 0);
  static_assert(Cell{} == Cell{0, 0} && Box{} == Box{{0, 0}, {-1, -1}});
  constexpr Box box = Box{}.with({2, 3}).with({-1, 4});
  static_assert(box == Box{{-1, 3}, {2, 4}} && box.width() == 4 && box.height() == 2);
  static_assert(box.index({-1, 3}) == 0 && box.index({2, 3}) == 3 && box.index({-1, 4}) == 4);
  static_assert(box.has({0, 3}) && !box.has({0, 5}) && box.widened(1).has({0, 5}));
  static_assert(box.widened(1) == Box{{-2, 2}, {3, 5}});
  static_assert(!box.has({-2, 3}) && !box.has({3, 3}) && !box.has({0, 2}));
  static_assert(box.has({-1, 3}) && box.has({2, 3}) && box.has({-1, 4}) && box.has({2, 4}));
  CHECK(box.cells() == 8);
}

TEST_CASE("grid: points and cells") {
  const Raster raster{0.1F};
  CHECK(raster.cell({0.05F, -0.05F}) == Cell{0, -1});
  CHECK(raster.cell({-0.25F, 0.31F}) == Cell{-3, 3});
  CHECK(raster.middle({-3, 3}).x_m == Approx(-0.25F));
  CHECK(Raster{0.0F}.resolution_m() == 0.04F);
  CHECK(Raster{0.001F}.resolution_m() == 0.001F);
  CHECK(Raster{0.0009F}.resolution_m() == 0.04F);
  CHECK(Raster{1.0F}.resolution_m() == 1.0F);
  CHECK(Raster{1.01F}.resolution_m() == 0.04F);
  CHECK(Raster{std::numeric_limits<float>::quiet_NaN()}.resolution_m() == 0.04F);
  CHECK(Raster::has({1000.0F, -1000.0F}));
  CHECK_FALSE(Raster::has({1000.1F, 0.0F}));
  CHECK_FALSE(Raster::has({0.0F, -1000.1F}));
  CHECK_FALSE(Raster::has({0.0F, std::numeric_limits<float>::quiet_NaN()}));
  CHECK_FALSE(Raster::has({-std::numeric_limits<float>::infinity(), 0.0F}));
}

TEST_CASE("grid: grows to what is touched, keeps what was there, and no further than its bound") {
  Grid<int> grid{7, 40'000};
  CHECK(grid.at({0, 0}) == 7);
  CHECK(grid.box().empty());
  Random random{1};
  std::vector<std::pair<Cell, int>> kept;
  for (int i = 0; i < 200; ++i) {
    const Cell c{random.within(-60, 60), random.within(-60, 60)};
    int* const at = grid.reach(c);
    REQUIRE(at != nullptr);
    *at = i;
    kept.emplace_back(c, i);
    for (std::size_t k = 0; k < kept.size(); ++k) {
      int last = kept[k].second;
      for (std::size_t later = k + 1; later < kept.size(); ++later)
        if (kept[later].first == kept[k].first) last = kept[later].second;
      REQUIRE(grid.at(kept[k].first) == last);
    }
  }
  const Box before = grid.box();
  CHECK(grid.reach({10'000, 0}) == nullptr);
  CHECK(grid.reach({0, -1'000'000}) == nullptr);
  CHECK(grid.box() == before);
  // A bound that the margin alone would pass still lets single cells in.
  Grid<char> small{0, 4};
  CHECK(small.reach({5, 5}) != nullptr);
  CHECK(small.reach({6, 6}) != nullptr);
  CHECK(small.reach({7, 7}) == nullptr);
}

TEST_CASE("grid: there is room for 32 cells around what is touched, as long as that is within the bound") {
  Grid<char> all{0, 65 * 65};
  REQUIRE(all.reach({3, -4}) != nullptr);
  CHECK(all.box() == Box{{-29, -36}, {35, 28}});
  Grid<char> less{0, 65 * 65 - 1};
  REQUIRE(less.reach({3, -4}) != nullptr);
  CHECK(less.box() == Box{{3, -4}, {3, -4}});
}

TEST_CASE("grid: cells of a line by hand") {
  const Raster raster{1.0F};
  CHECK(line(raster, {0.5F, 0.5F}, {3.5F, 0.5F}) == std::vector<Cell>{{0, 0}, {1, 0}, {2, 0}, {3, 0}});
  CHECK(line(raster, {0.5F, 0.5F}, {0.5F, -1.5F}) == std::vector<Cell>{{0, 0}, {0, -1}, {0, -2}});
  // y = x / 2 + 0.25: enters the upper row at x = 1.5
  CHECK(line(raster, {0.5F, 0.5F}, {2.5F, 1.5F}) == std::vector<Cell>{{0, 0}, {1, 0}, {1, 1}, {2, 1}});
  CHECK(line(raster, {0.5F, 0.5F}, {0.6F, 0.4F}) == std::vector<Cell>{{0, 0}});
}

TEST_CASE("grid: a line is without gaps, ends where it should, and stays beside itself") {
  Random random{2};
  const Raster raster{0.04F};
  const auto point = [&] {
    return Point{static_cast<float>(random.within(-3000, 3000)) / 1000.0F,
                 static_cast<float>(random.within(-3000, 3000)) / 1000.0F};
  };
  for (int run = 0; run < 3000; ++run) {
    const Point from = point(), to = point();
    const auto cells = line(raster, from, to);
    REQUIRE(cells.front() == raster.cell(from));
    REQUIRE(cells.back() == raster.cell(to));
    for (std::size_t i = 1; i < cells.size(); ++i)
      REQUIRE(std::abs(cells[i].x - cells[i - 1].x) + std::abs(cells[i].y - cells[i - 1].y) == 1);
    for (const Cell c : cells)  // half of a cell's diagonal
      REQUIRE(distance_m(Wall{from, to}, raster.middle(c)) <= 0.0284F);
  }
}

TEST_CASE("grid: visits end on request") {
  int n = 0;
  for_each_cell(Raster{1.0F}, {0.5F, 0.5F}, {9.5F, 0.5F}, [&](Cell) { return ++n < 3; });
  CHECK(n == 3);
}

TEST_CASE("grid: distance of two points") {
  CHECK(distance_m(Point{1.0F, 2.0F}, Point{4.0F, -2.0F}) == Approx(5.0F));
  CHECK(distance_m(Point{-1.0F, 2.0F}, Point{2.0F, 6.0F}) == Approx(5.0F));
  CHECK(distance_m(Point{3.0F, 4.0F}, Point{3.0F, 4.0F}) == 0.0F);
}

TEST_CASE("grid: distance from a wall") {
  const Wall wall{{0.0F, 0.0F}, {2.0F, 0.0F}};
  CHECK(distance_m(wall, {1.0F, 0.5F}) == Approx(0.5F));
  CHECK(distance_m(wall, {-3.0F, 4.0F}) == Approx(5.0F));
  // Beside each end and the middle of a slanting one, and beyond both ends.
  const Wall slanting{{10.0F, 20.0F}, {13.0F, 24.0F}};
  for (const Point p : {Point{14.0F, 17.0F}, Point{15.5F, 19.0F}, Point{9.0F, 27.0F}, Point{17.0F, 21.0F},
                        Point{16.0F, 28.0F}, Point{7.0F, 16.0F}})
    CHECK(distance_m(slanting, p) == Approx(5.0F));
  CHECK(distance_m(Wall{{1.0F, 1.0F}, {1.0F, 1.0F}}, {1.0F, 2.0F}) == Approx(1.0F));
}

}  // namespace cognitive_grid_test
