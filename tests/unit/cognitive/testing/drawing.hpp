/// Maps drawn in characters, for tests: `#` occupied, `.` free, blank unknown. Cells of 10 cm, unless given;
/// the lower left character is cell 0, 0.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "ocm/cognitive/map.hpp"

namespace ocm::test {

[[nodiscard]] inline motion::Point middle_of(const cognitive::Map& map, cognitive::Cell c) {
  return map.raster().middle(c);
}

/// Draws a map through its own door: a beam of no length of its own a cell, from a robot that is a point.
/// `most_cells`: as many as are drawn leave no room around them.
[[nodiscard]] inline cognitive::Map map_of(const std::vector<std::string>& rows, float cell_m = 0.10F,
                                           std::size_t most_cells = std::size_t{1} << 22) {
  cognitive::MapOptions options;
  options.most_cells = most_cells;
  options.resolution_m = cell_m;
  options.beam.half_width_rad = 0.0F;
  options.beam.hit = 4.0F;
  options.beam.pass = 0.0F;
  options.beam.unsure_m = 1.0F;   // what is before it stays as it is
  options.beam.clear_m = 0.001F;  // nothing seen frees the cell of the sensor
  options.beam.pass_nothing = -1.0F;
  cognitive::Map map{options};
  cognitive::Shape point;
  point.width_m = point.length_m = 0.0F;
  for (std::size_t row = 0; row < rows.size(); ++row)
    for (std::size_t column = 0; column < rows[row].size(); ++column) {
      const int x = static_cast<int>(column), y = static_cast<int>(rows.size() - 1 - row);
      const motion::Point p = map.raster().middle({x, y});
      if (rows[row][column] == '.') map.take({{p.x_m, p.y_m, 0.0F}, point}, {});
      if (rows[row][column] != '#') continue;
      // Seen from 20 cm to the left by all four sensors, which look the same way.
      cognitive::Shape watcher = point;
      watcher.tower.sensor_heading_deg = {0.0F, 0.0F, 0.0F, 0.0F};
      map.take({{p.x_m - 0.20F, p.y_m, 0.0F}, watcher}, {0, 0, 0, 0, 20, 20, 20, 20});
    }
  return map;
}

}  // namespace ocm::test
