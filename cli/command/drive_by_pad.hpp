/// `drive --gamepad`: a gamepad, a bus, and what a person reads meanwhile.
#pragma once

#include <string>
#include <vector>

#include "cli/command/refusal_watch.hpp"
#include "cli/command/timeline.hpp"
#include "cli/shared/session.hpp"

namespace ocm::cli {

struct PadDriveOptions {
  std::string device;               ///< "/dev/input/event5"
  std::vector<std::string> speeds;  ///< of a stick fully deflected, as typed; default: 10cm/s 45deg/s
  words::CommandOptions command;
  Timeline::Others others = Timeline::Others::refused;
  Confirm confirm = Confirm::yes;
};

/// Until Start, a signal, or the end of the pad: then the motors rest. The exit code; leaves through `fail`
/// where there is no such pad or no bus, and as a drive does.
[[nodiscard]] int drive_by_pad(Session& session, const PadDriveOptions& options);

}  // namespace ocm::cli
