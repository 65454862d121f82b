/// Ways for a round robot through what a map knows to be free: how far every cell is from the next obstacle,
/// what each cell costs to reach, and the way there as straight pieces.
///
/// A cell is passable when it is free and the robot's circle around it touches nothing: obstacles are
/// inflated, to a fifth of a cell. What was not seen is not passable. A robot that stands closer to
/// something already may leave on cells that are ever farther. Costs are metres, more where it is narrow.
/// [Dijkstra 1959; Felzenszwalb, Huttenlocher: Distance transforms of sampled functions, 2012]
///
/// O(cells) for a terrain, O(cells log cells) for all routes from one place. Pure; host only.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <queue>
#include <span>
#include <utility>
#include <vector>

#include "ocm/cognitive/grid.hpp"
#include "ocm/cognitive/map.hpp"

namespace ocm::cognitive {

/// Something round that keeps others away: a robot, along the way that it is about to take.
struct Moving {
  std::vector<motion::Point> way{};  ///< where it stands, and the corners to come
  float radius_m = 0.0F;
};

/// A map as it is now, and how far each of its cells is from the nearest thing.
class Terrain {
 public:
  explicit Terrain(const Map& map, std::span<const Moving> others = {})
      : map_(&map), raster_(map.raster()), box_(map.box()) {
    clearance_.resize(static_cast<std::size_t>(box_.cells()));
    if (box_.empty()) return;
    transform();
    for (const Moving& other : others) keep_off(other);
  }

  [[nodiscard]] const Box& box() const noexcept { return box_; }
  [[nodiscard]] const Raster& raster() const noexcept { return raster_; }
  [[nodiscard]] CellState state(Cell c) const noexcept { return map_->state(c); }
  /// Metres from a cell's middle to the nearest obstacle, negative inside one; 0 outside of the map.
  [[nodiscard]] float clearance_m(Cell c) const noexcept {
    return box_.has(c) ? clearance_[box_.index(c)] : 0.0F;
  }
  [[nodiscard]] bool passable(Cell c, float radius_m) const noexcept {
    return box_.has(c) && state(c) == CellState::free && clearance_m(c) >= radius_m;
  }
  /// Nothing that is known hides one from the other: no occupied cell between, the last one aside.
  [[nodiscard]] bool sees(motion::Point from, motion::Point to) const {
    bool clear = true;
    const Cell end = raster_.cell(to);
    for_each_cell(raster_, from, to, [&](Cell c) {
      clear = c == end || state(c) != CellState::occupied;
      return clear;
    });
    return clear;
  }
  /// No occupied cell lies between two points, the first one aside.
  [[nodiscard]] bool open(motion::Point from, motion::Point to) const {
    bool clear = true;
    const Cell start = raster_.cell(from);
    for_each_cell(raster_, from, to, [&](Cell c) {
      clear = c == start || state(c) != CellState::occupied;
      return clear;
    });
    return clear;
  }
  /// A robot can drive straight from one to the other. One that begins closer to something may come no
  /// closer.
  [[nodiscard]] bool straight(motion::Point from, motion::Point to, float radius_m) const {
    const float needed = std::min(radius_m, clearance_m(raster_.cell(from)));
    bool clear = true;
    for_each_cell(raster_, from, to, [&](Cell c) {
      clear = state(c) == CellState::free && clearance_m(c) >= needed;
      return clear;
    });
    return clear;
  }

 private:
  static constexpr float far = 1e12F;

  /// One line of squared distances: lower envelope of the parabolas over each cell.
  static void transform_line(std::vector<float>& line, std::vector<float>& out, std::vector<std::size_t>& at,
                             std::vector<float>& border) {
    const std::size_t n = line.size();
    const auto crossing = [&line](std::size_t q, std::size_t v) {
      const auto x = static_cast<float>(q);
      const auto y = static_cast<float>(v);
      return (line[q] + x * x - line[v] - y * y) / (2 * x - 2 * y);
    };
    std::size_t k = 0;
    at[0] = 0;
    border[0] = -far;
    border[1] = far;
    for (std::size_t q = 1; q < n; ++q) {
      float s = crossing(q, at[k]);
      while (k > 0 && s <= border[k]) s = crossing(q, at[--k]);  // none is as low as border[0]
      at[++k] = q;
      border[k] = s;
      border[k + 1] = far;
    }
    k = 0;
    for (std::size_t q = 0; q < n; ++q) {
      while (border[k + 1] < static_cast<float>(q)) ++k;
      const float d = static_cast<float>(q) - static_cast<float>(at[k]);
      out[q] = d * d + line[at[k]];
    }
  }
  void transform() {
    const auto width = static_cast<std::size_t>(box_.width());
    const auto height = static_cast<std::size_t>(box_.height());
    for (int y = box_.low.y; y <= box_.high.y; ++y)
      for (int x = box_.low.x; x <= box_.high.x; ++x)
        clearance_[box_.index({x, y})] = state({x, y}) == CellState::occupied ? 0.0F : far;
    const std::size_t longest = std::max(width, height);
    std::vector<float> line, out(longest), border(longest + 1);
    std::vector<std::size_t> at(longest);
    line.resize(height);
    for (std::size_t x = 0; x < width; ++x) {
      for (std::size_t y = 0; y < height; ++y) line[y] = clearance_[y * width + x];
      transform_line(line, out, at, border);
      for (std::size_t y = 0; y < height; ++y) clearance_[y * width + x] = out[y];
    }
    line.resize(width);
    for (std::size_t y = 0; y < height; ++y) {
      for (std::size_t x = 0; x < width; ++x) line[x] = clearance_[y * width + x];
      transform_line(line, out, at, border);
      // To the near border of the obstacle's cell, not to its middle.
      for (std::size_t x = 0; x < width; ++x)
        clearance_[y * width + x] =
            out[x] == 0.0F ? 0.0F : (std::sqrt(out[x]) - 0.5F) * raster_.resolution_m();
    }
  }
  void keep_off(const Moving& other) {
    for (std::size_t i = 0; i < other.way.size(); ++i) {
      const Wall leg{other.way[i], other.way[std::min(i + 1, other.way.size() - 1)]};
      for (int y = box_.low.y; y <= box_.high.y; ++y)
        for (int x = box_.low.x; x <= box_.high.x; ++x) {
          float& clearance = clearance_[box_.index({x, y})];
          clearance = std::min(clearance, distance_m(leg, raster_.middle({x, y})) - other.radius_m);
        }
    }
  }

  const Map* map_;
  Raster raster_;
  Box box_;
  std::vector<float> clearance_;
};

/// All ways of one robot from where it stands.
class Routes {
 public:
  Routes(const Terrain& terrain, motion::Point from, float radius_m)
      : terrain_(&terrain), box_(terrain.box()), from_(from), radius_m_(radius_m) {
    cost_.assign(static_cast<std::size_t>(box_.cells()), unreachable);
    before_.resize(cost_.size());
    if (Raster::has(from) && box_.has(terrain.raster().cell(from))) search();
  }

  static constexpr float unreachable = std::numeric_limits<float>::infinity();

  /// Metres, more where it is narrow; `unreachable`.
  [[nodiscard]] float cost(Cell c) const noexcept { return box_.has(c) ? cost_[box_.index(c)] : unreachable; }
  [[nodiscard]] bool reaches(Cell c) const noexcept { return cost(c) < unreachable; }

  /// Corners of the way to a cell, where the robot stands first; empty when there is no way.
  [[nodiscard]] std::vector<motion::Point> way_to(Cell goal) const {
    if (!reaches(goal)) return {};
    const Raster& raster = terrain_->raster();
    std::vector<motion::Point> cells{raster.middle(goal)};
    const Cell start = raster.cell(from_);
    for (Cell c = goal; c != start;) {
      c = before_[box_.index(c)];
      cells.push_back(c == start ? from_ : raster.middle(c));
    }
    if (cells.size() == 1) cells.push_back(from_);
    std::reverse(cells.begin(), cells.end());
    return straightened(cells);
  }

 private:
  /// Narrower than that beyond the robot's own circle, a metre costs up to three.
  static constexpr float comfort_m = 0.10F;

  [[nodiscard]] bool may_step(Cell from, Cell to) const {
    if (terrain_->passable(to, radius_m_)) return true;
    if (!box_.has(to) || terrain_->state(to) != CellState::free) return false;
    const float before = terrain_->clearance_m(from);
    return before < radius_m_ && terrain_->clearance_m(to) > before;  // out of a tight place
  }
  [[nodiscard]] float step_cost(Cell to, float metres) const {
    const float spare = terrain_->clearance_m(to) - radius_m_;
    return metres * (1.0F + 2.0F * std::clamp(1.0F - spare / comfort_m, 0.0F, 1.0F));
  }
  void search() {
    using Entry = std::pair<float, std::size_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    const float side = terrain_->raster().resolution_m();
    const Cell start = terrain_->raster().cell(from_);
    cost_[box_.index(start)] = 0.0F;
    open.push({0.0F, box_.index(start)});
    const auto width = static_cast<std::size_t>(box_.width());
    while (!open.empty()) {
      const auto [cost, index] = open.top();
      open.pop();
      if (cost > cost_[index]) continue;
      const Cell c{box_.low.x + static_cast<int>(index % width),
                   box_.low.y + static_cast<int>(index / width)};
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const Cell next{c.x + dx, c.y + dy};
          if ((dx == 0 && dy == 0) || !may_step(c, next)) continue;
          // A corner is not cut where one of both sides is not free.
          if (dx != 0 && dy != 0 &&
              (terrain_->state({c.x + dx, c.y}) != CellState::free ||
               terrain_->state({c.x, c.y + dy}) != CellState::free))
            continue;
          const float through = cost + step_cost(next, dx != 0 && dy != 0 ? 1.4142135F * side : side);
          if (through >= cost_[box_.index(next)]) continue;
          cost_[box_.index(next)] = through;
          before_[box_.index(next)] = c;
          open.push({through, box_.index(next)});
        }
    }
  }
  /// From each corner as far as there is a straight line.
  [[nodiscard]] std::vector<motion::Point> straightened(const std::vector<motion::Point>& cells) const {
    std::vector<motion::Point> corners{cells.front()};
    for (std::size_t i = 0; i + 1 < cells.size();) {
      std::size_t next = i + 1;
      while (next + 1 < cells.size() && terrain_->straight(cells[i], cells[next + 1], radius_m_)) ++next;
      corners.push_back(cells[next]);
      i = next;
    }
    return corners;
  }

  const Terrain* terrain_;
  Box box_;
  motion::Point from_;
  float radius_m_;
  std::vector<float> cost_;
  std::vector<Cell> before_;
};

}  // namespace ocm::cognitive
