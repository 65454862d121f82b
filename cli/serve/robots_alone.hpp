/// `serve` of robots behind a central, without a bus: live, where their watch has a thread of its own, or of
/// a log of the central's line.
#pragma once

#include "cli/fleet/line_replay.hpp"
#include "cli/serve/page_server.hpp"

namespace ocm::cli::serve {

/// Until a signal comes, or it is over; the exit code.
[[nodiscard]] int serve_robots(PageServer& server);
[[nodiscard]] int serve_robots_of_log(PageServer& server, fleet::LineReplay replay);

}  // namespace ocm::cli::serve
