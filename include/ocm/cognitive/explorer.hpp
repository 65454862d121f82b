/// Where a robot should look next: to the place from which most of the border between free and unknown is
/// seen, for the least way. Several robots get different goals, and none plans a way close to another's. What
/// a robot gets is one straight piece at a time, planned from where it really is.
/// [Yamauchi: A frontier-based approach for autonomous exploration, CIRA 1997; for several robots: Burgard et
/// al., Coordinated multi-robot exploration, 2005]
///
/// A border cell that could not be seen is looked at from nearer by, and then given up, so that it ends:
/// at most `most_tries` goals a cell. A robot that is called back goes towards home, and goals that far away
/// are not chosen again. Ways lead through free cells only (routes.hpp).
///
/// Pure, time is handed in. A decision costs a few passes over the map: milliseconds in a room.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/cognitive/map.hpp"
#include "ocm/cognitive/routes.hpp"
#include "ocm/mapper/link/sentence.hpp"

namespace ocm::cognitive {

struct ExplorerOptions {
  float margin_m = 0.03F;          ///< between the robot's circle and what the map shows
  float arrive_m = 0.06F;          ///< so near is there
  float longest_m = 0.60F;         ///< a piece: then the map is looked at again
  float view_m = 0.45F;            ///< from so far a border is looked at
  float look_m = 0.30F;            ///< what a look costs, as metres of way: many short ways or few long ones
  float apart_m = 0.60F;           ///< between the goals of two robots
  std::size_t least_unknown = 16;  ///< cells: smaller holes between beams are no goal
  std::size_t least_gain = 3;      ///< border cells: fewer are no goal
  std::uint8_t most_tries = 3;     ///< looks at a border cell
  unsigned most_pieces = 30;       ///< on the way to one goal
  float grow_m = 0.5F;             ///< by so much the range grows again behind a call
  unsigned most_fruitless = 6;     ///< so often without a goal that was reached
  base::Duration look = std::chrono::seconds{4};           ///< standing at the goal, for the tower to turn
  motion::Point home{};                                    ///< where a robot that is called back goes
  float range_m = std::numeric_limits<float>::infinity();  ///< from home: beyond it there are no goals
};

/// A robot as the explorer needs it.
struct Scout {
  std::uint8_t robot = 0;
  Body body{};
  bool call_back = false;
  bool too_far = false;  ///< it is called back because the radio does not reach farther: it never will
  bool lost = false;     ///< only in the way
};

/// What a robot is to do now that it has nothing to do.
struct Order {
  enum class Kind : std::uint8_t {
    drive,  ///< `set_point`
    look,   ///< stand, and ask again at `until`
    wait,   ///< there is something left, but others are in the way
    done,   ///< nothing left that it could reach
  };
  Kind kind = Kind::done;
  mapper::link::SetPoint set_point{};
  base::Time until{};
};

/// The straight way to a point as a set point: turned first, in whole degrees and centimetres, at most
/// `longest_m`.
[[nodiscard]] inline mapper::link::SetPoint set_point_to(const motion::Pose& from, motion::Point to,
                                                         float longest_m) {
  const motion::Point seen = motion::to_robot(from, to);
  const float way = std::min(std::hypot(seen.x_m, seen.y_m), std::min(longest_m, 300.0F));
  const float angle = way > 0.0F ? motion::degrees(std::atan2(seen.y_m, seen.x_m)) : 0.0F;
  return {static_cast<std::int16_t>(std::lround(angle)), static_cast<std::int16_t>(std::floor(way * 100.0F))};
}

/// Where a robot is that has carried it out.
[[nodiscard]] inline motion::Point end_of(const motion::Pose& from,
                                          const mapper::link::SetPoint& piece) noexcept {
  const float heading = from.heading_rad + motion::radians(static_cast<float>(piece.angle));
  const float way = static_cast<float>(piece.distance) / 100.0F;
  return {from.x_m + way * std::cos(heading), from.y_m + way * std::sin(heading)};
}

/// Border cells: free, beside unknown ones of which there are enough together.
[[nodiscard]] inline std::vector<Cell> frontiers(const Map& map, std::size_t least_unknown) {
  const Box box = map.box().widened(1);  // around the map is nothing but unknown
  if (map.box().empty()) return {};
  // Unknown cells that belong to a hole too small to count are set aside first.
  std::vector<char> small(static_cast<std::size_t>(box.cells()), 0);
  std::vector<char> seen(small.size(), 0);
  std::vector<Cell> hole;
  constexpr Cell around[] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
  const auto visit = [&](Cell c) {
    if (!box.has(c) || seen[box.index(c)] != 0 || map.state(c) != CellState::unknown) return;
    seen[box.index(c)] = 1;
    hole.push_back(c);
  };
  for (int y = box.low.y; y <= box.high.y; ++y)
    for (int x = box.low.x; x <= box.high.x; ++x) {
      hole.clear();
      visit({x, y});
      for (std::size_t i = 0; i < hole.size(); ++i)
        for (const Cell d : around) visit({hole[i].x + d.x, hole[i].y + d.y});
      if (hole.size() >= least_unknown) continue;
      for (const Cell c : hole) small[box.index(c)] = 1;
    }
  std::vector<Cell> out;
  for (int y = box.low.y + 1; y < box.high.y; ++y)
    for (int x = box.low.x + 1; x < box.high.x; ++x) {
      if (map.state({x, y}) != CellState::free) continue;
      const bool border = std::any_of(std::begin(around), std::end(around), [&](Cell d) {
        const Cell next{x + d.x, y + d.y};
        return map.state(next) == CellState::unknown && small[box.index(next)] == 0;
      });
      if (border) out.push_back({x, y});
    }
  return out;
}

/// What is left of the border between free and unknown, in cells, and why.
struct Left {
  std::size_t edge = 0;  ///< all free cells with something else beside them: how long a closed border is
  std::size_t out_of_range = 0;  ///< beyond the range that was set
  std::size_t bad_link = 0;      ///< beyond where a robot was called back
  std::size_t unseen = 0;        ///< could not be seen, or no way leads there
  /// Share of the edge beyond which it is known what there is.
  [[nodiscard]] double known() const noexcept {
    if (edge == 0) return 0;
    return 1 - static_cast<double>(out_of_range + bad_link + unseen) / static_cast<double>(edge);
  }
  /// So much of the edge is what beams leave open in a room that a robot has seen, and more is not.
  /// [measured: docs/cognitive.md]
  static constexpr double most_not_visited = 0.10, most_unseen = 0.25;
  [[nodiscard]] bool not_visited() const noexcept {
    return static_cast<double>(out_of_range + bad_link) > most_not_visited * static_cast<double>(edge);
  }
  [[nodiscard]] bool is_known() const noexcept {
    return edge != 0 && !not_visited() &&
           static_cast<double>(unseen) <= most_unseen * static_cast<double>(edge);
  }
};

/// What became of goals. They wrap.
struct ExplorerCounters {
  std::uint32_t goals = 0;    ///< chosen
  std::uint32_t reached = 0;  ///< and looked from
  std::uint32_t stalled = 0;  ///< given up: the robot did not come nearer
  std::uint32_t cut_off = 0;  ///< given up: there is no way any more
  std::uint32_t pieces = 0;   ///< set points given
  std::uint32_t calls = 0;    ///< of robots that were called back
  std::uint32_t grown = 0;    ///< times that the range grew again behind a call
  std::uint32_t blocked = 0;  ///< times that a robot had to wait for another
  friend constexpr bool operator==(const ExplorerCounters&, const ExplorerCounters&) = default;
};

class Explorer {
 public:
  explicit Explorer(const ExplorerOptions& options = {})
      : options_(options),
        range_m_(options.range_m),
        limit_m_(options.range_m),
        tries_(0, std::size_t{1} << 24) {}

  /// The robot of this number is idle: what now? `robots` are all that there are, itself among them. A robot
  /// that is not among them is done.
  [[nodiscard]] Order next(std::uint8_t robot, std::span<const Scout> robots, const Map& map,
                           base::Time now) {
    const auto self = std::find_if(robots.begin(), robots.end(),
                                   [robot](const Scout& other) { return other.robot == robot; });
    if (self == robots.end() || self->lost || !Raster::has(place(self->body.pose))) return {};
    Mission& mission = missions_[robot];
    const Terrain terrain{map, in_the_way(robot, robots)};
    const Routes routes{terrain, place(self->body.pose), radius(*self)};
    if (self->call_back) return home(*self, mission, terrain, routes);
    if (mission.homewards) leave(mission);
    if (mission.goal) {
      if (const auto order = pursue(*self, mission, map, terrain, routes, now)) return *order;
    }
    bool chosen = choose(*self, mission, robots, map, terrain, routes);
    while (!chosen && grow(map)) chosen = choose(*self, mission, robots, map, terrain, routes);
    if (!chosen) return nothing(robot, robots, map);
    const auto order = pursue(*self, mission, map, terrain, routes, now);
    return order ? *order : Order{Order::Kind::wait, {}, {}};
  }

  /// The robot restarted somewhere, or is gone: its goal is free for others.
  void forget(std::uint8_t robot) { missions_.erase(robot); }
  /// Where the robot is on its way to, if it is.
  [[nodiscard]] std::optional<motion::Point> goal(std::uint8_t robot) const {
    const auto at = missions_.find(robot);
    return at == missions_.end() ? std::nullopt : at->second.goal;
  }
  /// From home: beyond there are no goals. Shrinks when robots are called back, and grows again when nothing
  /// is left within, as long as that leads to something.
  [[nodiscard]] float range_m() const noexcept { return range_m_; }
  /// What of the place is not known.
  [[nodiscard]] Left left(const Map& map) const {
    Left left;
    for (int y = map.box().low.y; y <= map.box().high.y; ++y)
      for (int x = map.box().low.x; x <= map.box().high.x; ++x) left.edge += at_edge(map, {x, y}) ? 1 : 0;
    for (const Cell c : frontiers(map, options_.least_unknown)) {
      const float far = distance_m(map.raster().middle(c), options_.home);
      ++(far > limit_m_ ? left.out_of_range : far > range_m_ ? left.bad_link : left.unseen);
    }
    return left;
  }
  [[nodiscard]] const ExplorerCounters& counters() const noexcept { return counters_; }

 private:
  struct Mission {
    std::optional<motion::Point> goal{};
    std::vector<Cell> targets{};       ///< border cells that are to be seen from the goal
    std::vector<motion::Point> way{};  ///< corners that others keep off
    std::optional<base::Time> looks_until{};
    std::optional<motion::Pose> was{};  ///< when the last piece was given
    unsigned pieces = 0;
    unsigned stalls = 0;
    bool homewards = false;
  };

  [[nodiscard]] static bool at_edge(const Map& map, Cell c) {
    const auto free = [&map](Cell at) { return map.state(at) == CellState::free; };
    return free(c) &&
           !(free({c.x + 1, c.y}) && free({c.x - 1, c.y}) && free({c.x, c.y + 1}) && free({c.x, c.y - 1}));
  }
  /// A bad link may have been a bad moment. True: the range is larger now.
  bool grow(const Map& map) {
    if (!(range_m_ < limit_m_) || left(map).bad_link == 0) return false;
    if (counters_.reached != reached_when_grown_) fruitless_ = 0;
    if (fruitless_ >= options_.most_fruitless) return false;
    ++fruitless_;
    ++counters_.grown;
    reached_when_grown_ = counters_.reached;
    range_m_ = std::min(range_m_ + options_.grow_m, limit_m_);
    return true;
  }
  [[nodiscard]] float radius(const Scout& robot) const noexcept {
    return robot.body.shape.radius_m() + options_.margin_m;
  }

  [[nodiscard]] std::vector<Moving> in_the_way(std::uint8_t self, std::span<const Scout> robots) const {
    std::vector<Moving> moving = stops_;
    for (const Scout& other : robots) {
      if (other.robot == self || !Raster::has(place(other.body.pose))) continue;
      Moving it{{place(other.body.pose)}, other.body.shape.radius_m()};
      const auto mission = missions_.find(other.robot);
      if (mission != missions_.end() && !other.lost)
        it.way.insert(it.way.end(), mission->second.way.begin(), mission->second.way.end());
      moving.push_back(std::move(it));
    }
    return moving;
  }

  /// Looked at, with or without success: a try for every cell that was to be seen.
  void settle(Mission& mission) {
    for (const Cell c : mission.targets) {
      std::uint8_t* const tries = tries_.reach(c);
      if (tries != nullptr && *tries < UINT8_MAX) ++*tries;
    }
    leave(mission);
  }
  static void leave(Mission& mission) { mission = Mission{}; }

  /// The next order on the way to the goal; none when the goal is settled or given up.
  [[nodiscard]] std::optional<Order> pursue(const Scout& self, Mission& mission, const Map& map,
                                            const Terrain& terrain, const Routes& routes, base::Time now) {
    const motion::Point goal = *mission.goal;
    mission.way.clear();
    if (mission.looks_until || distance_m(place(self.body.pose), goal) <= options_.arrive_m) {
      if (!mission.looks_until) mission.looks_until = now + options_.look;
      if (now < *mission.looks_until && wanted(mission, map))
        return Order{Order::Kind::look, {}, *mission.looks_until};
      ++counters_.reached;
      return settle(mission), std::nullopt;
    }
    const bool still = stands_still(self, mission);
    if (still || ++mission.pieces > options_.most_pieces) {
      ++counters_.stalled;
      if (still) remember(self);
      return settle(mission), std::nullopt;
    }
    const auto way = routes.way_to(map.raster().cell(goal));
    const auto order = way.empty() ? std::nullopt : drive(self, mission, terrain, way);
    if (order) return order;
    ++counters_.cut_off;
    return settle(mission), std::nullopt;
  }
  /// Whether any of the cells is still a border that may be seen from here.
  [[nodiscard]] static bool wanted(const Mission& mission, const Map& map) {
    return std::any_of(mission.targets.begin(), mission.targets.end(), [&map](Cell c) {
      return map.state(c) == CellState::free && (map.state({c.x + 1, c.y}) == CellState::unknown ||
                                                 map.state({c.x - 1, c.y}) == CellState::unknown ||
                                                 map.state({c.x, c.y + 1}) == CellState::unknown ||
                                                 map.state({c.x, c.y - 1}) == CellState::unknown);
    });
  }
  /// It was sent, and twice did next to nothing: something is in front of it.
  [[nodiscard]] static bool stands_still(const Scout& self, Mission& mission) {
    constexpr float step_m = 0.02F;
    constexpr unsigned most = 2;
    if (!mission.was) return false;
    const bool still = distance_m(place(self.body.pose), place(*mission.was)) < step_m;
    mission.stalls = still ? mission.stalls + 1 : 0;
    return mission.stalls >= most;
  }
  /// What stopped it the map may not show, such as the end of a thin wall: there is something before it.
  void remember(const Scout& self) {
    constexpr std::size_t most = 64;
    constexpr float beyond_m = 0.02F, radius_m = 0.02F;
    const Shape& shape = self.body.shape;
    const float ahead = shape.centre_m + shape.length_m / 2 + beyond_m;
    if (stops_.size() == most) stops_.erase(stops_.begin());
    stops_.push_back({{motion::to_world(self.body.pose, {ahead, 0.0F})}, radius_m});
  }

  /// The first piece of a way. Whole degrees lead aside a little: where that would be through something, the
  /// piece is shorter; none when even a short one is.
  [[nodiscard]] std::optional<Order> drive(const Scout& self, Mission& mission, const Terrain& terrain,
                                           const std::vector<motion::Point>& way) {
    constexpr float step_m = 0.03F;  // a corner so near is passed by
    const bool near = way.size() > 2 && distance_m(way[0], way[1]) < step_m;
    for (float longest = options_.longest_m; longest > 0.01F; longest /= 2) {
      const mapper::link::SetPoint piece = set_point_to(self.body.pose, way[near ? 2 : 1], longest);
      if (!terrain.open(way[0], end_of(self.body.pose, piece))) continue;
      mission.way.assign(way.begin() + 1, way.end());
      mission.was = self.body.pose;
      ++counters_.pieces;
      return Order{Order::Kind::drive, piece, {}};
    }
    return std::nullopt;
  }

  /// Border cells that are worth a look, and not another robot's business.
  [[nodiscard]] std::vector<Cell> candidates(std::uint8_t self, std::span<const Scout> robots,
                                             const Map& map) const {
    std::vector<Cell> out = frontiers(map, options_.least_unknown);
    std::erase_if(out, [&](Cell c) {
      const motion::Point p = map.raster().middle(c);
      if (tries_.at(c) >= options_.most_tries || distance_m(p, options_.home) > range_m_) return true;
      return std::any_of(robots.begin(), robots.end(), [&](const Scout& other) {
        const auto taken = other.robot == self || other.lost ? std::nullopt : goal(other.robot);
        return taken && distance_m(p, *taken) < options_.view_m;
      });
    });
    return out;
  }
  [[nodiscard]] bool taken(std::uint8_t self, std::span<const Scout> robots, motion::Point p) const {
    return std::any_of(robots.begin(), robots.end(), [&](const Scout& other) {
      if (other.robot == self || other.lost) return false;
      const auto its = goal(other.robot);
      return its && distance_m(p, *its) < options_.apart_m;
    });
  }

  /// Of a grid of reachable places the one that shows most for its way.
  [[nodiscard]] bool choose(const Scout& self, Mission& mission, std::span<const Scout> robots,
                            const Map& map, const Terrain& terrain, const Routes& routes) {
    const std::vector<Cell> borders = candidates(self.robot, robots, map);
    const Raster& raster = map.raster();
    const Cell here = raster.cell(place(self.body.pose));
    double best = 0.0;
    std::vector<Cell> shown;
    for (int y = map.box().low.y; y <= map.box().high.y; ++y)
      for (int x = map.box().low.x; x <= map.box().high.x; ++x) {
        const Cell c{x, y};
        if (c != here && (x + y) % 2 != 0) continue;  // every other one, in narrow places too
        if (!routes.reaches(c) || (c != here && !terrain.passable(c, radius(self)))) continue;
        const motion::Point p = raster.middle(c);
        if (taken(self.robot, robots, p) || distance_m(p, options_.home) > range_m_) continue;
        show(terrain, borders, p, shown);
        if (shown.size() < options_.least_gain) continue;
        const double worth = static_cast<double>(shown.size()) / (routes.cost(c) + options_.look_m);
        if (worth <= best) continue;
        best = worth;
        mission.goal = c == here ? place(self.body.pose) : p;
        mission.targets = shown;
      }
    if (best > 0.0) ++counters_.goals;
    return best > 0.0;
  }
  /// The border cells that are seen from a place: each the nearer by, the more often it was looked at.
  void show(const Terrain& terrain, const std::vector<Cell>& borders, motion::Point from,
            std::vector<Cell>& shown) const {
    shown.clear();
    for (const Cell c : borders) {
      const motion::Point p = terrain.raster().middle(c);
      const float view = options_.view_m / static_cast<float>(1 + tries_.at(c));
      if (distance_m(p, from) <= view && terrain.sees(from, p)) shown.push_back(c);
    }
  }
  /// No goal: for good, or for now.
  [[nodiscard]] Order nothing(std::uint8_t self, std::span<const Scout> robots, const Map& map) {
    const bool others = std::any_of(robots.begin(), robots.end(), [&](const Scout& other) {
      return other.robot != self && !other.lost && goal(other.robot);
    });
    if (!others || candidates(self, {}, map).empty()) return {};
    ++counters_.blocked;
    return {Order::Kind::wait, {}, {}};
  }

  /// Towards home, as far as a way is known; the place where it was called is remembered as too far.
  [[nodiscard]] Order home(const Scout& self, Mission& mission, const Terrain& terrain,
                           const Routes& routes) {
    const float far = distance_m(place(self.body.pose), options_.home);
    if (!mission.homewards) {
      leave(mission);  // it has not looked yet: that is no try
      mission.homewards = true;
      ++counters_.calls;
      constexpr float back_m = 0.20F, least_m = 0.5F;
      range_m_ = std::min(range_m_, std::max(far - back_m, least_m));
      if (self.too_far) limit_m_ = range_m_;
    }
    const Box& box = terrain.box();
    std::optional<Cell> best;
    float nearest = far - options_.arrive_m;
    for (int y = box.low.y; y <= box.high.y; ++y)
      for (int x = box.low.x; x <= box.high.x; ++x) {
        const float left = distance_m(terrain.raster().middle({x, y}), options_.home);
        if (left >= nearest || !routes.reaches({x, y})) continue;
        nearest = left;
        best = Cell{x, y};
      }
    if (!best || stands_still(self, mission)) return {Order::Kind::wait, {}, {}};
    mission.way.clear();
    const auto order = drive(self, mission, terrain, routes.way_to(*best));
    return order ? *order : Order{Order::Kind::wait, {}, {}};
  }

  ExplorerOptions options_;
  float range_m_;
  float limit_m_;  ///< which it does not outgrow
  unsigned fruitless_ = 0;
  std::uint32_t reached_when_grown_ = 0;
  std::map<std::uint8_t, Mission> missions_;
  Grid<std::uint8_t> tries_;
  std::vector<Moving> stops_;  ///< where robots were stopped by something
  ExplorerCounters counters_{};
};

}  // namespace ocm::cognitive
