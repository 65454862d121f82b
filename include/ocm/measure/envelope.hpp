/// A curve of any length, thinned to what a picture can show and no further: time is cut into columns, and
/// each keeps its first, last, lowest, highest, leftmost and rightmost point. No peak is lost, wherever it
/// is, and few points stay as they are. [Jugel et al., M4, VLDB 2014]
///
/// The columns double in width when the curve outgrows them, so its length need not be known. About
/// 500 KiB a curve, allocated once; O(1) a point on average.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "ocm/base/time.hpp"

namespace ocm::measure {

struct Point {
  base::Time time{};
  double x = 0;
  double y = 0;
  bool begins = false;       ///< a piece of the curve: no line leads here from the point before
  std::uint64_t number = 0;  ///< in the order in which they were added
};

class Envelope {
 public:
  static constexpr std::size_t columns = 2048;

  Envelope() : columns_(columns) {}

  /// Times are expected to rise. For a curve over time leave `x` the same. After a pause of more than five
  /// distances a new curve begins.
  void add(base::Time time, double x, double y) {
    Point point{time, x, y, count_ == 0, count_};
    if (count_ == 0) origin_ = time;
    if (count_ > 0) point.begins = after_pause((time - last_).count());
    last_ = time;
    ++count_;
    const std::int64_t since = std::max<std::int64_t>((time - origin_).count(), 0);
    while (since / width_ >= static_cast<std::int64_t>(columns)) widen();
    columns_[static_cast<std::size_t>(since / width_)].add(point);
  }

  /// How many were added.
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  /// Those that are left, in the order in which they were added.
  [[nodiscard]] std::vector<Point> points() const {
    std::vector<Point> out;
    for (const Column& column : columns_) column.into(out);
    return out;
  }

 private:
  struct Column {
    enum Extreme : std::size_t { first, last, lowest, highest, leftmost, rightmost, extremes };
    bool any = false;
    std::array<Point, extremes> points;

    void add(const Point& point) {
      if (!any) points.fill(point);
      any = true;
      points[last] = point;
      if (is_below(point.y, points[lowest].y)) points[lowest] = point;
      if (is_below(-point.y, -points[highest].y)) points[highest] = point;
      if (is_below(point.x, points[leftmost].x)) points[leftmost] = point;
      if (is_below(-point.x, -points[rightmost].x)) points[rightmost] = point;
    }
    /// What is no number is kept until a number comes.
    static bool is_below(double value, double kept) { return value < kept || std::isnan(kept); }
    void add(const Column& later) {
      if (!later.any) return;
      // Each by itself may be what was kept; the last one again, to be the last.
      for (const std::size_t which : {first, lowest, highest, leftmost, rightmost, last})
        add(later.points[which]);
    }
    void into(std::vector<Point>& out) const {
      if (!any) return;
      auto sorted = points;
      const auto before = [](const Point& a, const Point& b) { return a.number < b.number; };
      const auto same = [](const Point& a, const Point& b) { return a.number == b.number; };
      std::sort(sorted.begin(), sorted.end(), before);
      out.insert(out.end(), sorted.begin(), std::unique(sorted.begin(), sorted.end(), same));
    }
  };

  [[nodiscard]] bool after_pause(std::int64_t distance) noexcept {
    const bool pause = usual_ > 0 && distance / 5 > usual_;
    // What comes after a pause may have another period; until then the average of about the last eight.
    usual_ = pause ? 0 : usual_ == 0 ? distance : usual_ + (distance - usual_) / 8;
    return pause;
  }

  void widen() {
    for (std::size_t i = 0; i < columns / 2; ++i) {
      columns_[i] = columns_[2 * i];
      columns_[i].add(columns_[2 * i + 1]);
    }
    std::fill(columns_.begin() + columns / 2, columns_.end(), Column{});
    width_ *= 2;
  }

  std::vector<Column> columns_;
  std::int64_t width_ = 1;  // ns
  base::Time origin_{};
  base::Time last_{};
  std::uint64_t count_ = 0;
  std::int64_t usual_ = 0;  // distance of two points, ns; 0: not known
};

}  // namespace ocm::measure
