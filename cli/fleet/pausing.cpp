#include "cli/fleet/pausing.hpp"

#include <chrono>
#include <cstdint>

namespace ocm::cli::fleet {

using namespace std::chrono_literals;

bool pause_until_seen(CentralLine& line, unsigned index, bool paused) {
  constexpr base::Duration again = 500ms, longest = 10s, quiet_for = 1500ms;
  constexpr int least_words = 2;  // of a robot that is not just out of reach
  const RobotNow begin = line.robot(index);
  base::Time say_at{}, quiet_since = CentralLine::now() + again, updated = begin.updated, heard = begin.heard;
  std::uint32_t before = begin.pieces;
  int words = 0;
  const bool obeys = line.wait(longest, [&] {
    const base::Time now = CentralLine::now();
    if (now >= say_at) {
      say_at = now + again;
      paused ? line.end().pause(index) : line.end().unpause(index);
      if (paused) line.end().ping(index);  // while it drives it says no idle
    }
    const RobotNow robot = line.robot(index);
    if (robot.updated != updated && !paused) return true;
    if (robot.updated != updated || robot.pieces != before) {
      updated = robot.updated;
      before = robot.pieces;
      quiet_since = now;
      words = 0;
      heard = robot.heard;
    }
    if (robot.heard != heard) {
      heard = robot.heard;
      ++words;
    }
    return robot.lost || (paused && words >= least_words && now - quiet_since >= quiet_for);
  });
  return obeys && !line.robot(index).lost;
}

bool seems_paused(CentralLine& line, unsigned index) {
  const std::uint32_t before = line.robot(index).pieces;
  const bool updates = line.wait(2500ms, [&] {
    const RobotNow robot = line.robot(index);
    return robot.update.has_value() || robot.pieces != before;
  });
  const RobotNow robot = line.robot(index);
  return !updates && (robot.last == mapper::link::Kind::idle || robot.last == mapper::link::Kind::pong);
}

}  // namespace ocm::cli::fleet
