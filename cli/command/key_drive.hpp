/// Driving by keys that are held: a set point while a key is, and rest when it is released.
#pragma once

#include <string>
#include <vector>

#include "cli/command/refusal_watch.hpp"
#include "cli/command/timeline.hpp"
#include "cli/shared/session.hpp"

namespace ocm::cli {

struct KeyDriveOptions {
  std::vector<std::string> speeds;  ///< forward and turning, as typed; default: 10cm/s 45deg/s
  words::CommandOptions command;
  Timeline::Others others = Timeline::Others::refused;
  Confirm confirm = Confirm::yes;
};

/// Until q, a signal, or the end of the terminal: then the motors rest. The exit code; leaves through `fail`
/// where there is no terminal or no bus, and as a drive does.
[[nodiscard]] int drive_by_keys(Session& session, const KeyDriveOptions& options);

}  // namespace ocm::cli
