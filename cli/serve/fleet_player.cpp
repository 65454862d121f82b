#include "cli/serve/fleet_player.hpp"

#include <chrono>
#include <optional>
#include <utility>

#include "cli/fleet/picture.hpp"
#include "cli/serve/commands.hpp"
#include "cli/serve/foxglove.hpp"
#include "cli/serve/state.hpp"
#include "cli/shared/json.hpp"

namespace ocm::cli::serve {
namespace {

using namespace std::chrono_literals;

constexpr base::Duration bar_interval = 100ms, robots_interval = 200ms;

}  // namespace

void FleetPlayer::obey(const Order& order) {
  if (order.kind != Order::Kind::playback) return;
  const auto request = playback_of(order.payload);
  if (!request) return viewers_->tell(order.viewer, foxglove::status(foxglove::Level::error, request.error));
  if (request->paused >= 0) paused_ = request->paused == 1;
  if (request->speed > 0) replay_.faster(request->speed / replay_.playing().speed);
  next_bar_ = {};
  if (!request->at) return;
  replay_.go_to(*request->at);
  ++jumps_;
  map_.clear();
  next_robots_ = next_map_ = {};
}

void FleetPlayer::publish(Clock::time_point now) {
  // First that it was wound, so that a viewer forgets what was before, then what is there.
  if (now >= next_bar_) {
    viewers_->publish_state(playback_, now_ns(), playback_state(replay_.playing(), paused_, jumps_));
    next_bar_ = now + bar_interval;
  }
  if (now >= next_robots_) {
    publish_robots();
    next_robots_ = now + robots_interval;
  }
  if (now >= next_map_) {
    publish_map();
    next_map_ = now + map_interval(map_.size());
  }
}

void FleetPlayer::publish_robots() {
  Json robots = Json::array();
  Json unplaced = Json::array();
  for (const fleet::RobotNow& robot : replay_.robots()) {
    if (!robot.origin_known) unplaced.push_back(robot.name);
    robots.push_back(fleet_robot(robot, replay_.now(), std::nullopt));
  }
  viewers_->publish_state(channels_.fleet, now_ns(),
                          fleet_state(name_, std::move(robots), std::move(unplaced)).line());
}

void FleetPlayer::publish_map() {
  if (!viewers_->wanted(channels_.map)) return;
  std::string grid = fleet::to_grid(replay_.drawing().map());
  if (!grid.starts_with('{') || grid == map_) return;
  map_ = std::move(grid);
  const std::uint64_t time = now_ns();
  viewers_->publish_state(channels_.map, time, map_message(map_, time));
}

}  // namespace ocm::cli::serve
