/// Values on the cells of a plane, without knowing beforehand how far it goes: the stored rectangle grows to
/// what is touched, up to a bound; beyond it nothing is stored, and the result says so. And the cells that a
/// straight line passes through.
///
/// O(1) an access; growing copies, and happens once in `margin` cells. `sizeof(T)` a cell. Host only.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "ocm/motion/pose.hpp"

namespace ocm::cognitive {

struct Cell {
  int x = 0;
  int y = 0;
  friend constexpr bool operator==(const Cell&, const Cell&) = default;
};

/// Cells from `low` to `high`, both inside; empty when `high` is below `low`.
struct Box {
  Cell low{0, 0};
  Cell high{-1, -1};

  [[nodiscard]] constexpr bool empty() const noexcept { return high.x < low.x || high.y < low.y; }
  [[nodiscard]] constexpr std::int64_t width() const noexcept {
    return empty() ? 0 : std::int64_t{high.x} - low.x + 1;
  }
  [[nodiscard]] constexpr std::int64_t height() const noexcept {
    return empty() ? 0 : std::int64_t{high.y} - low.y + 1;
  }
  [[nodiscard]] constexpr std::int64_t cells() const noexcept { return width() * height(); }
  [[nodiscard]] constexpr bool has(Cell c) const noexcept {
    return c.x >= low.x && c.x <= high.x && c.y >= low.y && c.y <= high.y;
  }
  /// Row by row; `c` is inside.
  [[nodiscard]] constexpr std::size_t index(Cell c) const noexcept {
    return static_cast<std::size_t>((std::int64_t{c.y} - low.y) * width() + (std::int64_t{c.x} - low.x));
  }
  [[nodiscard]] constexpr Box with(Cell c) const noexcept {
    if (empty()) return {c, c};
    return {{std::min(low.x, c.x), std::min(low.y, c.y)}, {std::max(high.x, c.x), std::max(high.y, c.y)}};
  }
  [[nodiscard]] constexpr Box widened(int by) const noexcept {
    return {{low.x - by, low.y - by}, {high.x + by, high.y + by}};
  }
  friend constexpr bool operator==(const Box&, const Box&) = default;
};

/// No robot is farther from the origin: 1 km. What a robot can say ends at 328 m.
inline constexpr float farthest_m = 1000.0F;

/// Points to cells and back.
class Raster {
 public:
  /// `resolution_m`: side of a cell, 1 mm to 1 m; anything else counts as 4 cm.
  explicit Raster(float resolution_m) noexcept
      : resolution_m_(resolution_m >= 0.001F && resolution_m <= 1.0F ? resolution_m : 0.04F) {}

  [[nodiscard]] float resolution_m() const noexcept { return resolution_m_; }
  /// Finite, and near enough to have a cell.
  [[nodiscard]] static bool has(motion::Point p) noexcept {
    return std::abs(p.x_m) <= farthest_m && std::abs(p.y_m) <= farthest_m;
  }
  /// Of a point that `has`.
  [[nodiscard]] Cell cell(motion::Point p) const noexcept {
    return {static_cast<int>(std::floor(p.x_m / resolution_m_)),
            static_cast<int>(std::floor(p.y_m / resolution_m_))};
  }
  [[nodiscard]] motion::Point middle(Cell c) const noexcept {
    return {(static_cast<float>(c.x) + 0.5F) * resolution_m_,
            (static_cast<float>(c.y) + 0.5F) * resolution_m_};
  }

 private:
  float resolution_m_;
};

template <class T>
class Grid {
 public:
  Grid(T blank, std::size_t most_cells) : blank_(blank), most_cells_(most_cells) {}

  /// What was never touched is blank.
  [[nodiscard]] T at(Cell c) const noexcept { return box_.has(c) ? values_[box_.index(c)] : blank_; }
  /// To be changed; nullptr when storing it would take more than `most_cells`.
  [[nodiscard]] T* reach(Cell c) {
    if (!box_.has(c) && !grow(c)) return nullptr;
    return &values_[box_.index(c)];
  }
  /// What is stored.
  [[nodiscard]] const Box& box() const noexcept { return box_; }

 private:
  static constexpr int margin = 32;

  [[nodiscard]] bool grow(Cell c) {
    Box wanted = box_.with(c).widened(margin);
    if (static_cast<std::uint64_t>(wanted.cells()) > most_cells_) wanted = box_.with(c);
    if (static_cast<std::uint64_t>(wanted.cells()) > most_cells_) return false;
    std::vector<T> values(static_cast<std::size_t>(wanted.cells()), blank_);
    for (int y = box_.low.y; y <= box_.high.y; ++y) {
      const auto from = values_.begin() + static_cast<std::ptrdiff_t>(box_.index({box_.low.x, y}));
      std::copy(from, from + static_cast<std::ptrdiff_t>(box_.width()),
                values.begin() + static_cast<std::ptrdiff_t>(wanted.index({box_.low.x, y})));
    }
    values_ = std::move(values);
    box_ = wanted;
    return true;
  }

  T blank_;
  std::size_t most_cells_;
  Box box_{};
  std::vector<T> values_;
};

[[nodiscard]] constexpr motion::Point place(const motion::Pose& pose) noexcept {
  return {pose.x_m, pose.y_m};
}
[[nodiscard]] inline float distance_m(motion::Point a, motion::Point b) noexcept {
  return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m);
}

/// A straight line from here to there: a wall, or a leg of a way.
struct Wall {
  motion::Point from{};
  motion::Point to{};
};

[[nodiscard]] inline float distance_m(const Wall& wall, motion::Point p) noexcept {
  const float x = wall.to.x_m - wall.from.x_m;
  const float y = wall.to.y_m - wall.from.y_m;
  const float square = x * x + y * y;
  float part = 0.0F;
  if (square > 0.0F)
    part = std::clamp(((p.x_m - wall.from.x_m) * x + (p.y_m - wall.from.y_m) * y) / square, 0.0F, 1.0F);
  return std::hypot(p.x_m - wall.from.x_m - part * x, p.y_m - wall.from.y_m - part * y);
}

/// Every cell that the straight line from `from` to `to` passes through, in order, both ends included, until
/// `visit` answers false. Both points have cells. [Amanatides, Woo: A fast voxel traversal algorithm,
/// Eurographics 1987]
template <class Visit>
void for_each_cell(const Raster& raster, motion::Point from, motion::Point to, Visit visit) {
  Cell at = raster.cell(from);
  const Cell end = raster.cell(to);
  const double dx = double{to.x_m} - from.x_m;
  const double dy = double{to.y_m} - from.y_m;
  const int step_x = dx > 0 ? 1 : -1;
  const int step_y = dy > 0 ? 1 : -1;
  constexpr double never = std::numeric_limits<double>::infinity();
  const double side = raster.resolution_m();
  const auto first = [side](double x, int cell, double d) {
    return d == 0 ? never : ((d > 0 ? cell + 1 : cell) * side - x) / d;
  };
  double next_x = first(from.x_m, at.x, dx);
  double next_y = first(from.y_m, at.y, dy);
  const double each_x = dx == 0 ? never : side / std::abs(dx);
  const double each_y = dy == 0 ? never : side / std::abs(dy);
  // As many steps as there are borders between both cells: rounding cannot lead past the end.
  for (int steps = std::abs(end.x - at.x) + std::abs(end.y - at.y); visit(at) && steps > 0; --steps) {
    const bool along_x = at.y == end.y || (at.x != end.x && next_x < next_y);
    (along_x ? at.x : at.y) += along_x ? step_x : step_y;
    (along_x ? next_x : next_y) += along_x ? each_x : each_y;
  }
}

}  // namespace ocm::cognitive
