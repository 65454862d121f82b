#include "cli/fleet/pausing.hpp"

#include <chrono>
#include <cstdint>

namespace ocm::cli::fleet {

using namespace std::chrono_literals;

namespace {

constexpr base::Duration say_pause_again = 500ms, longest_pausing = 10s, quiet_for = 1500ms;
constexpr int least_words = 2;  // of a robot that is not just out of reach

}  // namespace

Pausing::Pausing(const RobotNow& robot, bool paused, base::Time now)
    : index_(robot.index),
      paused_(paused),
      begin_(now),
      quiet_since_(now + say_pause_again),
      updated_(robot.updated),
      heard_(robot.heard),
      pieces_(robot.pieces) {}

Pausing::Seen Pausing::step(LineEnd& line, base::Time now) {
  if (now - begin_ >= longest_pausing) return Seen::never;
  if (now >= say_at_) {
    say_at_ = now + say_pause_again;
    paused_ ? line.pause(index_) : line.unpause(index_);
    if (paused_) line.ping(index_);  // while it drives it says no idle
  }
  const RobotNow robot = line.robot(index_);
  if (robot.lost) return Seen::lost;
  if (robot.updated != updated_ && !paused_) return Seen::obeys;
  if (robot.updated != updated_ || robot.pieces != pieces_) {
    updated_ = robot.updated;
    pieces_ = robot.pieces;
    quiet_since_ = now;
    words_ = 0;
    heard_ = robot.heard;
  }
  if (robot.heard != heard_) {
    heard_ = robot.heard;
    ++words_;
  }
  return paused_ && words_ >= least_words && now - quiet_since_ >= quiet_for ? Seen::obeys : Seen::not_yet;
}

}  // namespace ocm::cli::fleet
