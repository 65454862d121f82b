/// Has a central's line, with links to all its robots, and does nothing but serve it to the programs that
/// join: links stay up, and no command needs to look for robots again.
#pragma once

#include "cli/fleet/central_line.hpp"

namespace ocm::cli::fleet {

/// Until a signal comes. Reports robots that get lost or whose link gets bad; `call_back`: one that drives
/// then is called back. Returns the exit code.
[[nodiscard]] int keep_line(const LineOptions& options, bool call_back);

}  // namespace ocm::cli::fleet
