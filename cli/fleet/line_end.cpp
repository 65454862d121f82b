#include "cli/fleet/line_end.hpp"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include "cli/fleet/line_time.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli::fleet {

bool halt(LineEnd& line, std::string_view verb, const std::vector<unsigned>& robots,
          const std::function<bool(unsigned)>& meant) {
  using mapper::server::Progress;
  constexpr base::Duration any_leg = std::chrono::seconds{20};
  const auto drives = [&](unsigned index) {
    if (!meant(index)) return false;
    const RobotNow robot = line.robot(index);
    // Without a link it stops by itself.
    return robot.linked && robot.progress != Progress::none && robot.progress != Progress::stopped &&
           !robot.standing;
  };
  std::vector<unsigned> driving;
  std::copy_if(robots.begin(), robots.end(), std::back_inserter(driving), drives);
  for (const unsigned index : driving) (void)line.go(index, {});  // a stop is always taken
  const base::Time end = line_time() + any_leg;
  const int signals = interruptions();
  // Another program may have sent a robot since: that one answers for it.
  const auto stops = [&](unsigned index) { return line.is_ours(index) && drives(index); };
  const auto any = [&] { return std::any_of(driving.begin(), driving.end(), stops); };
  while (any() && line_time() < end && interruptions() == signals) line.exchange();
  for (const unsigned index : driving)
    if (stops(index))
      remark(fmt::format(
          "{}: {} may still drive: nothing shows that it has heard the stop, which was said {}; its "
          "leg ends after {} cm",
          verb, line.robot(index).name, counted(line.robot(index).times_said, "time"),
          mapper::server::longest_leg_cm));
  return !any();
}

}  // namespace ocm::cli::fleet
