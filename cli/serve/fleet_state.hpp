/// What viewers are shown of robots behind a central, live or from a log.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "ocm/base/time.hpp"
#include "ocm/motion/pose.hpp"

#include "cli/fleet/robot_now.hpp"
#include "cli/shared/clock.hpp"
#include "cli/shared/json.hpp"

namespace ocm::cli::serve {

/// On the channels of a server's bus or log.
struct FleetChannels {
  std::uint32_t fleet = 0;
  std::uint32_t map = 0;
};

/// The wall clock's time, of messages.
[[nodiscard]] inline std::uint64_t now_ns() noexcept {
  return static_cast<std::uint64_t>(unix_time().time_since_epoch().count());
}
/// As `robots --json` has it, with its age, and its place in the map as far as that is known.
[[nodiscard]] Json fleet_robot(const fleet::RobotNow& robot, base::Time now,
                               std::optional<motion::Point> target);
/// All robots of a line, each as `fleet_robot` has it; of a log nothing else is said. `line`: its name.
/// `unplaced`: names of those whose place in the map is not known.
[[nodiscard]] Json fleet_state(std::string_view line, Json robots, Json unplaced);
/// A map as fleet::to_grid gives it, with a time.
[[nodiscard]] std::string map_message(std::string_view grid, std::uint64_t time_ns);
/// From one message of a map of so many bytes to the next: a large one comes less often.
[[nodiscard]] base::Duration map_interval(std::size_t bytes) noexcept;

}  // namespace ocm::cli::serve
