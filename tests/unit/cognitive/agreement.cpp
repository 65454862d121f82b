#include "ocm/cognitive/agreement.hpp"

#include <array>
#include <vector>

#include <catch2/catch.hpp>

#include "unit/cognitive/testing/drawing.hpp"
#include "unit/cognitive/testing/room.hpp"

namespace cognitive_agreement_test {

using namespace ocm::cognitive;
using ocm::motion::Point;

/// Cells of 10 cm, beams without width.
MapOptions options() {
  MapOptions options;
  options.resolution_m = 0.10F;
  options.beam.half_width_rad = 0.0F;
  return options;
}
/// Occupied where the beam ends, seen from 30 cm below: often enough to be sure.
void hit(Map& map, Cell cell) {
  const Point p = map.raster().middle(cell);
  for (int i = 0; i < 5; ++i)
    map.take({{p.x_m, p.y_m - 0.30F, ocm::motion::pi / 2}, {}}, {0, 0, 0, 0, 30, 0, 0, 0});
}

TEST_CASE("agreement: of nothing") {
  const Map map;
  const Agreement none = agreement(map, {}, {});
  CHECK(none.precision == 1.0);
  CHECK(none.recall == 1.0);
  CHECK(none.explored == 1.0);
  CHECK(none.occupied + none.wall_cells + none.area_cells == 0);
  CHECK(Agreement{}.f1() == 1.0);
  CHECK(Agreement{}.explored == 1.0);
}

TEST_CASE("agreement: an empty map knows no wall and no place") {
  const Map map{options()};
  const auto walls = ocm::test::rectangle(0, 0, 1, 1);
  const std::array inside{Point{0.5F, 0.5F}};
  const Agreement none = agreement(map, walls, inside);
  CHECK(none.precision == 1.0);
  CHECK(none.recall == 0.0);
  CHECK(none.f1() == 0.0);
  CHECK(none.explored == 0.0);
  // Walls on the lines between cells belong to the cells above and to the right: 9 by 9 are inside.
  CHECK(none.area_cells == 81);
}

TEST_CASE("agreement: right and wrong cells, by hand") {
  Map map{options()};
  // A wall from 0, 0.05 to 1, 0.05: cells 0 to 9 of row 0, and 10, where it ends.
  const std::vector<Wall> walls{{{0.0F, 0.05F}, {0.99F, 0.05F}}};
  for (const int x : {0, 1, 2, 3, 4}) hit(map, {x, 0});
  hit(map, {7, 5});  // there is nothing
  const Agreement half = agreement(map, walls, {}, 0.05F);
  CHECK(half.occupied == 6);
  CHECK(half.wall_cells == 10);
  CHECK(half.precision == Approx(5.0 / 6.0));
  CHECK(half.recall == Approx(0.5));
  CHECK(half.f1() == Approx(2 * (5.0 / 6) * 0.5 / (5.0 / 6 + 0.5)));
  // With a tolerance of a cell the neighbour counts, too.
  CHECK(agreement(map, walls, {}, 0.10F).recall == Approx(0.6));
}

TEST_CASE("agreement: the whole of a map without room around it counts") {
  // What is seen from 0, 0 fills the map: two cells to the left, as there is room for 12.
  MapOptions small = options();
  small.most_cells = 12;
  Map map{small};
  for (const int x : {0, -2}) hit(map, {x, 3});
  REQUIRE(map.box() == Box{{-2, 0}, {0, 3}});
  CHECK(agreement(map, {}, {}).occupied == 2);
  CHECK(agreement(map, {}, {}).precision == 0.0);
  // A tolerance reaches as far to each side, and no farther.
  const auto recall = [&](Point wall, float tolerance_m) {
    const std::vector<Wall> walls{{wall, wall}};
    return agreement(ocm::test::map_of({"     ", "     ", "  #  ", "     ", "     "}), walls, {}, tolerance_m)
        .recall;
  };
  for (const Point beside :
       {Point{0.05F, 0.25F}, Point{0.45F, 0.25F}, Point{0.25F, 0.05F}, Point{0.25F, 0.45F}}) {
    CHECK(recall(beside, 0.21F) == 1.0);
    CHECK(recall(beside, 0.19F) == 0.0);
  }
  CHECK(recall({0.05F, 0.05F}, 0.27F) == 0.0);
  CHECK(recall({0.05F, 0.05F}, 0.29F) == 1.0);
}

TEST_CASE("agreement: what is exactly as far as the tolerance is within it, on each side") {
  // Lengths that a float holds exactly: cells of an eighth of a metre, and a tolerance of two of them.
  const Map map = ocm::test::map_of({"     ", "     ", "  #  ", "     ", "     "}, 0.125F);
  for (const Cell cell : {Cell{0, 2}, Cell{4, 2}, Cell{2, 0}, Cell{2, 4}}) {
    CAPTURE(cell.x, cell.y);
    const Point p = map.raster().middle(cell);
    const std::vector<Wall> walls{{p, p}};
    const Agreement exact = agreement(map, walls, {}, 0.25F);
    CHECK(exact.occupied == 1);
    CHECK(exact.precision == 1.0);
    CHECK(exact.recall == 1.0);
    const Agreement less = agreement(map, walls, {}, 0.249F);
    CHECK(less.precision == 0.0);
    CHECK(less.recall == 0.0);
  }
}

TEST_CASE("agreement: a cell of two walls counts once, and a wall that is no place has none") {
  const Map map{options()};
  auto walls = ocm::test::rectangle(0.05F, 0.05F, 1.05F, 1.05F);  // 11 by 11 cells around
  CHECK(agreement(map, walls, {}).wall_cells == 40);
  walls.push_back({{0.55F, 0.05F}, {0.55F, 1.05F}});  // 11, of which both ends are there already
  CHECK(agreement(map, walls, {}).wall_cells == 49);
  walls.push_back({{0.55F, 0.55F}, {2000.0F, 0.55F}});
  walls.push_back({{0.55F, -2000.0F}, {0.55F, 0.55F}});
  CHECK(agreement(map, walls, {}).wall_cells == 49);
}

TEST_CASE("agreement: one number of two shares, be they small") {
  Agreement some;
  CHECK(some.occupied + some.wall_cells + some.area_cells == 0);
  some.precision = 0.25;
  some.recall = 0.5;
  CHECK(some.f1() == Approx(1.0 / 3.0));
  some.precision = some.recall = 0.0;
  CHECK(some.f1() == 0.0);
}

TEST_CASE("agreement: the place is what can be reached without crossing a wall") {
  const Map map{options()};
  auto walls = ocm::test::rectangle(0.05F, 0.05F, 1.05F, 1.05F);
  walls.push_back({{0.55F, 0.05F}, {0.55F, 1.05F}});  // parted in the middle
  const std::array left{Point{0.3F, 0.3F}};
  CHECK(agreement(map, walls, left).area_cells == 36);
  const std::array both{Point{0.3F, 0.3F}, Point{0.8F, 0.8F}};
  CHECK(agreement(map, walls, both).area_cells == 72);
  const std::array outside{Point{5.0F, 5.0F}};
  CHECK(agreement(map, walls, outside).area_cells == 0);
}

}  // namespace cognitive_agreement_test
