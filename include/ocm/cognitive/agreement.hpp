/// How well a map agrees with walls that are known: what it shows that is there, what is there that it shows,
/// and how much of the place it knows at all.
///
/// Pure; O(cells x walls near them). Numbers are shares, 0 to 1; a share of nothing is 1, and its count 0
/// tells.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "ocm/cognitive/grid.hpp"
#include "ocm/cognitive/map.hpp"

namespace ocm::cognitive {

struct Agreement {
  std::size_t occupied = 0;    ///< cells that the map calls so
  std::size_t wall_cells = 0;  ///< cells that true walls pass through
  std::size_t area_cells = 0;  ///< cells of the place that a robot could see
  double precision = 1.0;      ///< of the occupied cells, those within the tolerance of a wall
  double recall = 1.0;         ///< of the walls' cells, those with an occupied one within the tolerance
  double explored = 1.0;       ///< of the place's cells, those that are known

  /// Harmonic mean of both: one number for "the walls are right".
  [[nodiscard]] double f1() const noexcept {
    return precision + recall > 0 ? 2 * precision * recall / (precision + recall) : 0.0;
  }
};

namespace detail {

/// Every cell that a wall passes through, once.
[[nodiscard]] inline std::vector<Cell> cells_of(const Raster& raster, std::span<const Wall> walls) {
  std::vector<Cell> cells;
  for (const Wall& wall : walls) {
    if (!Raster::has(wall.from) || !Raster::has(wall.to)) continue;
    for_each_cell(raster, wall.from, wall.to, [&](Cell c) {
      cells.push_back(c);
      return true;
    });
  }
  const auto before = [](Cell a, Cell b) { return a.y != b.y ? a.y < b.y : a.x < b.x; };
  std::sort(cells.begin(), cells.end(), before);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

[[nodiscard]] inline bool occupied_near(const Map& map, Cell cell, float tolerance_m) {
  const Raster& raster = map.raster();
  const int reach = static_cast<int>(std::ceil(tolerance_m / raster.resolution_m()));
  const motion::Point here = raster.middle(cell);
  for (int y = cell.y - reach; y <= cell.y + reach; ++y)
    for (int x = cell.x - reach; x <= cell.x + reach; ++x) {
      const motion::Point p = raster.middle({x, y});
      if (std::hypot(p.x_m - here.x_m, p.y_m - here.y_m) <= tolerance_m &&
          map.state({x, y}) == CellState::occupied)
        return true;
    }
  return false;
}

/// Cells that can be reached from `inside` without crossing a wall. Open to the outside, the place ends with
/// the walls' bounding box.
[[nodiscard]] inline std::vector<Cell> place_of(const Raster& raster, std::span<const Cell> walls,
                                                std::span<const motion::Point> inside) {
  Box box;
  for (const Cell c : walls) box = box.with(c);
  if (box.empty()) return {};
  std::vector<char> seen(static_cast<std::size_t>(box.cells()), 0);
  for (const Cell c : walls) seen[box.index(c)] = 1;
  std::vector<Cell> place;
  const auto visit = [&](Cell c) {
    if (!box.has(c) || seen[box.index(c)] != 0) return;
    seen[box.index(c)] = 1;
    place.push_back(c);
  };
  for (const motion::Point p : inside)
    if (Raster::has(p)) visit(raster.cell(p));
  for (std::size_t i = 0; i < place.size(); ++i) {
    const Cell c = place[i];
    visit({c.x + 1, c.y});
    visit({c.x - 1, c.y});
    visit({c.x, c.y + 1});
    visit({c.x, c.y - 1});
  }
  return place;
}

[[nodiscard]] inline double share(std::size_t part, std::size_t whole) noexcept {
  return whole == 0 ? 1.0 : static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace detail

/// `inside`: points of the place itself, such as where the robots began.
[[nodiscard]] inline Agreement agreement(const Map& map, std::span<const Wall> walls,
                                         std::span<const motion::Point> inside, float tolerance_m = 0.06F) {
  Agreement out;
  const Raster& raster = map.raster();
  std::size_t right = 0;
  const Box& box = map.box();
  for (int y = box.low.y; y <= box.high.y; ++y)
    for (int x = box.low.x; x <= box.high.x; ++x) {
      if (map.state({x, y}) != CellState::occupied) continue;
      ++out.occupied;
      const motion::Point p = raster.middle({x, y});
      right += std::any_of(walls.begin(), walls.end(),
                           [&](const Wall& wall) { return distance_m(wall, p) <= tolerance_m; })
                   ? 1
                   : 0;
    }
  const auto wall_cells = detail::cells_of(raster, walls);
  const auto found = std::count_if(wall_cells.begin(), wall_cells.end(),
                                   [&](Cell c) { return detail::occupied_near(map, c, tolerance_m); });
  const auto place = detail::place_of(raster, wall_cells, inside);
  const auto known =
      std::count_if(place.begin(), place.end(), [&](Cell c) { return map.state(c) != CellState::unknown; });
  out.wall_cells = wall_cells.size();
  out.area_cells = place.size();
  out.precision = detail::share(right, out.occupied);
  out.recall = detail::share(static_cast<std::size_t>(found), out.wall_cells);
  out.explored = detail::share(static_cast<std::size_t>(known), out.area_cells);
  return out;
}

}  // namespace ocm::cognitive
