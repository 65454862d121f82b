/// One map of what several robots see: which updates are drawn, and where each robot was. While a robot turns
/// fast, the direction of its beams is not known, and its updates are counted instead.
///
/// Pure. O(cells of four beams) an update. Host only.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <span>
#include <vector>

#include "ocm/cognitive/fleet.hpp"
#include "ocm/cognitive/map.hpp"

namespace ocm::cognitive {

/// They wrap.
struct DrawingCounters {
  std::uint32_t turning = 0;  ///< updates not drawn, because the robot turned
  std::uint32_t drawn = 0;
};

class Drawing {
 public:
  /// `most_turn_deg`: between two updates that are drawn, in degrees.
  explicit Drawing(const MapOptions& map = {}, int most_turn_deg = 6)
      : most_turn_deg_(most_turn_deg), map_(map) {}

  /// An update of a robot, robot < Fleet::most_robots; `body` is in the map's frame, `others` stand around.
  void take(std::size_t robot, const Body& body, const mapper::link::Update& update,
            std::span<const Body> others) {
    Track& track = tracks_[robot];
    constexpr float step_m = 0.02F;
    if (track.path.empty() || distance_m(track.path.back(), place(body.pose)) >= step_m)
      track.path.push_back(place(body.pose));
    const int turned =
        track.heading ? std::abs(static_cast<int>(std::remainder(update.heading - *track.heading, 360.0)))
                      : 0;
    track.heading = update.heading;
    if (turned > most_turn_deg_) return void(++counters_.turning);
    if (map_.take(body, update, others)) ++counters_.drawn;
  }
  /// The robot was switched on again: its next heading does not follow from its last one.
  void restart(std::size_t robot) { tracks_[robot].heading.reset(); }

  [[nodiscard]] const Map& map() const noexcept { return map_; }
  [[nodiscard]] const DrawingCounters& counters() const noexcept { return counters_; }
  /// Where a robot was, a point each 2 cm; by its own estimate.
  [[nodiscard]] const std::vector<motion::Point>& path(std::size_t robot) const {
    return tracks_[robot].path;
  }

 private:
  struct Track {
    std::optional<int> heading{};  ///< of the last update, degrees
    std::vector<motion::Point> path{};
  };

  int most_turn_deg_;
  Map map_;
  std::array<Track, Fleet::most_robots> tracks_{};
  DrawingCounters counters_{};
};

}  // namespace ocm::cognitive
