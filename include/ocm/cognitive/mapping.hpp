/// Several robots draw one map: what the fleet hears goes into the map, and who is idle gets an order of the
/// explorer. Robots that should be called back are, at once. [Thesis 2, 14.3, 15.3]
///
/// Pure, time is handed in. O(beams) an update; an order costs some milliseconds. Host only.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "ocm/cognitive/drawing.hpp"
#include "ocm/cognitive/explorer.hpp"
#include "ocm/cognitive/fleet.hpp"
#include "ocm/cognitive/map.hpp"

namespace ocm::cognitive {

struct MappingOptions {
  MapOptions map{};
  ExplorerOptions explorer{};
  /// Degrees between two updates: while a robot turns that fast, the direction of its beams is not known.
  int most_turn_deg = 6;
  base::Duration again = std::chrono::seconds{1};  ///< before a robot that waits is asked for again
  /// A robot that was called back waits for a good link for so long; then it is done.
  base::Duration patience = std::chrono::minutes{2};
  /// Which robots draw and are sent: where the others began is not known. Empty: all that there are.
  std::vector<std::size_t> robots{};
};

struct MappingCounters {
  std::uint32_t turning = 0;  ///< updates not drawn, because the robot turned
  std::uint32_t drawn = 0;
  std::uint32_t orders = 0;
};

class Mapping {
 public:
  explicit Mapping(Fleet& fleet, const MappingOptions& options = {})
      : fleet_(&fleet),
        options_(options),
        drawing_(options.map, options.most_turn_deg),
        explorer_(options.explorer) {}

  /// To be called with each sentence, as Server::feed does.
  void heard(std::size_t robot, mapper::link::Kind kind) {
    if (robot >= Fleet::most_robots || !takes_part(robot)) return;
    // A robot has begun again; an answer to another program changes nothing.
    if (kind == mapper::link::Kind::handshake && !fleet_->robot(robot).update) {
      tracks_[robot] = Track{.held = tracks_[robot].held};
      drawing_.restart(robot);
      explorer_.forget(static_cast<std::uint8_t>(robot));
    }
    if (kind == mapper::link::Kind::update) draw(robot);
  }

  /// A robot that is held is left alone, for another program drives it; what it sees is drawn. What was left
  /// to it is left to the others.
  void hold(std::size_t robot, bool held) {
    if (robot >= Fleet::most_robots || tracks_[robot].held == held) return;
    tracks_[robot].held = held;
    tracks_[robot].order = {};
    tracks_[robot].asked = false;
    tracks_[robot].called = false;
    explorer_.forget(static_cast<std::uint8_t>(robot));
  }
  /// Gives orders to those who have nothing to do. Often: ten times a second.
  void step(base::Time now) {
    const std::vector<Scout> scouts = all();
    now_ = now;
    for (const Scout& scout : scouts) {
      Track& track = tracks_[scout.robot];
      if (scout.lost) {
        track.order = {};
        explorer_.forget(scout.robot);
        continue;
      }
      if (track.held) continue;
      const bool called = scout.call_back && !track.called;
      track.called = scout.call_back;
      if (called) track.called_at = now;
      const Robot& robot = fleet_->robot(scout.robot);
      // In the middle of a piece, too: stopped first, for it is sent from where it stands.
      if (called && !robot.idle) (void)fleet_->stop(scout.robot, now);
      if (path(scout.robot).empty()) continue;  // the map does not show yet what it sees
      if (!robot.idle || !robot.located || (!called && now < track.ask_at)) continue;
      track.order = explorer_.next(scout.robot, scouts, map(), now);
      obey(scout, track, now);
    }
  }
  /// No robot has anything left to do, or waits for one that has. A robot that is held may have.
  [[nodiscard]] bool done() const {
    bool any = false;
    for (const Scout& scout : all()) {
      if (scout.lost) continue;
      const Track& track = tracks_[scout.robot];
      any = true;
      if (track.held) return false;
      if (track.order.kind == Order::Kind::drive || track.order.kind == Order::Kind::look) return false;
      // Who waited because it was called back has not been asked since.
      if (!track.asked) return false;
      if (track.order.kind != Order::Kind::wait) continue;
      // Others were in its way: it is asked again, and then goes on or has nothing left.
      if (!scout.call_back && !track.waits_for_link) return false;
      if (now_ - track.called_at < options_.patience) return false;
    }
    return any;
  }

  [[nodiscard]] const Map& map() const noexcept { return drawing_.map(); }
  [[nodiscard]] const Explorer& explorer() const noexcept { return explorer_; }
  [[nodiscard]] MappingCounters counters() const noexcept {
    return {drawing_.counters().turning, drawing_.counters().drawn, orders_};
  }
  /// Where a robot was, a point each 2 cm; by its own estimate.
  [[nodiscard]] const std::vector<motion::Point>& path(std::size_t robot) const {
    return drawing_.path(robot);
  }

 private:
  struct Track {
    Order order{};
    base::Time ask_at{};
    bool asked = false;
    bool held = false;            ///< another program drives it
    bool waits_for_link = false;  ///< its order is of while it was called back
    bool called = false;
    base::Time called_at{};
  };

  [[nodiscard]] bool takes_part(std::size_t robot) const {
    return options_.robots.empty() ||
           std::find(options_.robots.begin(), options_.robots.end(), robot) != options_.robots.end();
  }
  /// Those that said where they are.
  [[nodiscard]] std::vector<Scout> all() const {
    std::vector<Scout> scouts;
    for (std::size_t i = 0; i < Fleet::most_robots; ++i) {
      const Robot& robot = fleet_->robot(i);
      if (!robot.update || !takes_part(i)) continue;
      scouts.push_back({static_cast<std::uint8_t>(i),
                        {robot.pose(), robot.shape()},
                        fleet_->call_back(i) != Advice::stay,
                        fleet_->call_back(i) == Advice::far_away,
                        robot.lost || !robot.linked});
    }
    return scouts;
  }
  void draw(std::size_t index) {
    const Robot& robot = fleet_->robot(index);
    std::vector<Body> others;
    for (const Scout& other : all())
      if (other.robot != index) others.push_back(other.body);
    drawing_.take(index, {robot.pose(), robot.shape()}, *robot.update, others);
  }
  void obey(const Scout& scout, Track& track, base::Time now) {
    track.asked = true;
    track.waits_for_link = scout.call_back;
    track.ask_at = now + options_.again;
    if (track.order.kind == Order::Kind::look) track.ask_at = std::min(track.order.until, track.ask_at);
    if (track.order.kind != Order::Kind::drive) return;
    ++orders_;
    track.ask_at = now;
    (void)fleet_->go(scout.robot, track.order.set_point, now);
  }

  Fleet* fleet_;
  MappingOptions options_;
  Drawing drawing_;
  Explorer explorer_;
  std::array<Track, Fleet::most_robots> tracks_{};
  base::Time now_{};  ///< of the last step
  std::uint32_t orders_ = 0;
};

}  // namespace ocm::cognitive
