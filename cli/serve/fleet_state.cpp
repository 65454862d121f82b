#include "cli/serve/fleet_state.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include <fmt/format.h>

namespace ocm::cli::serve {

Json fleet_robot(const fleet::RobotNow& robot, base::Time now, std::optional<motion::Point> target) {
  Json json = fleet::to_json(robot);
  json["progress"] = robot.busy();
  json["by"] = robot.by;
  json["age_s"] = robot.update ? Json(static_cast<double>((now - robot.updated).count()) / 1e9) : Json();
  json["at"] = Json();
  if (robot.origin_known && robot.update) {
    const motion::Pose pose = robot.pose();
    json["at"] = {{"x_m", pose.x_m}, {"y_m", pose.y_m}, {"heading_rad", pose.heading_rad}};
  }
  json["target"] = target ? Json{{"x_m", target->x_m}, {"y_m", target->y_m}} : Json();
  return json;
}

Json fleet_state(std::string_view line, Json robots, Json unplaced) {
  return {{"line", line},
          {"own", false},
          {"gone", ""},
          {"scans", false},
          {"map_by", ""},
          {"unplaced", std::move(unplaced)},
          {"robots", std::move(robots)}};
}

std::string map_message(std::string_view grid, std::uint64_t time_ns) {
  return fmt::format(R"({{"timestamp":{{"sec":{},"nsec":{}}},{})", time_ns / 1'000'000'000,
                     time_ns % 1'000'000'000, grid.substr(1));
}

base::Duration map_interval(std::size_t bytes) noexcept {
  constexpr base::Duration shortest = std::chrono::seconds{1};
  constexpr std::size_t bytes_per_s = 512 * 1024;
  return std::max<base::Duration>(shortest, std::chrono::milliseconds{1000 * bytes / bytes_per_s});
}

}  // namespace ocm::cli::serve
