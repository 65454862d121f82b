#include "cli/fleet/link_watch.hpp"

#include <fmt/format.h>

#include "ocm/cognitive/explorer.hpp"

#include "cli/shared/messages.hpp"

namespace ocm::cli::fleet {
namespace {

using cognitive::Advice;
using mapper::server::Progress;

}  // namespace

bool LinkWatch::step(LineEnd& line, const RobotNow& robot, bool call_back) {
  const bool bad = robot.linked && robot.advice != Advice::stay;
  // Not while it drives: the share of whole sentences follows the place by some seconds.
  const bool stands = robot.located && !robot.busy();
  if (phase_ == Phase::well && !bad && robot.update && (stands || !home_)) home_ = robot.update;
  if (phase_ == Phase::well && bad) {
    phase_ = Phase::bad;
    if (call_back && robot.busy() && robot.progress != Progress::stopping) call(line, robot);
    return true;
  }
  if (!bad && (phase_ == Phase::bad || over())) phase_ = Phase::well;
  if (phase_ != Phase::stopping && phase_ != Phase::returning && phase_ != Phase::settling) return false;
  if (robot.lost || !robot.linked || !line.is_ours(robot.index)) {
    phase_ = Phase::failed;
  } else if (phase_ == Phase::stopping) {
    if (robot.progress == Progress::stopped && robot.located) send_back(line, robot);
  } else if (phase_ == Phase::settling || is_final(robot.progress)) {
    if (is_final(robot.progress)) phase_ = Phase::back;
  } else if (!bad) {
    call(line, robot);
    if (phase_ == Phase::stopping) phase_ = Phase::settling;
  }
  return false;
}

void LinkWatch::call(LineEnd& line, const RobotNow& robot) {
  phase_ = line.go(robot.index, {}) ? Phase::failed : Phase::stopping;
}

void LinkWatch::send_back(LineEnd& line, const RobotNow& robot) {
  constexpr float near_m = 0.06F, longest_m = 3.0F;
  const motion::Pose here = cognitive::pose_of(*robot.update);
  const motion::Point there = cognitive::place(cognitive::pose_of(home_.value_or(*robot.update)));
  if (cognitive::distance_m(cognitive::place(here), there) < near_m) {
    phase_ = Phase::back;
    return;
  }
  phase_ = line.go(robot.index, cognitive::set_point_to(here, there, longest_m)) ? Phase::failed
                                                                                 : Phase::returning;
}

std::string words_of_link(const RobotNow& robot) {
  if (robot.advice == Advice::far_away)
    return fmt::format("{} is almost out of the radio's range", robot.name);
  return fmt::format("the link to {} is bad: {} % of its sentences come whole", robot.name,
                     robot.quality_per_mille / 10);
}

void warn_of_link(std::string_view verb, const RobotNow& robot) {
  if (robot.linked && robot.advice != Advice::stay)
    remark(fmt::format("{}: {}; bring the central or the robot nearer", verb, words_of_link(robot)));
}

}  // namespace ocm::cli::fleet
