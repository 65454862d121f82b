#include "cli/fleet/pause_seen.hpp"

#include <chrono>

#include "cli/fleet/pausing.hpp"

namespace ocm::cli::fleet {

using namespace std::chrono_literals;

bool pause_until_seen(CentralLine& line, unsigned index, bool paused) {
  Pausing pausing{line.robot(index), paused, CentralLine::now()};
  auto seen = Pausing::Seen::not_yet;
  (void)line.wait(1h, [&] {
    seen = pausing.step(line.end(), CentralLine::now());
    return seen != Pausing::Seen::not_yet;
  });
  return seen == Pausing::Seen::obeys;
}

bool seems_paused(CentralLine& line, unsigned index) {
  // The program that has the line may have heard updates of the robot before it was paused.
  const RobotNow before = line.robot(index);
  const bool updates = line.wait(2500ms, [&] {
    const RobotNow robot = line.robot(index);
    return robot.updated != before.updated || robot.pieces != before.pieces;
  });
  const RobotNow robot = line.robot(index);
  // A paused robot goes on to say that it is idle; one of which nothing comes is out of reach.
  return !updates && !robot.lost && robot.heard - robot.updated >= 1s &&
         (robot.last == mapper::link::Kind::idle || robot.last == mapper::link::Kind::pong);
}

void pause_unseen(CentralLine& line, unsigned index) {
  for (int times = 0; times < 3; ++times) line.end().pause(index);
}

}  // namespace ocm::cli::fleet
