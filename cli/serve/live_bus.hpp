/// `serve` on a bus: its frames to the page, what viewers command to the bus, through an operator where one
/// guards the robot.
#pragma once

#include <memory>

#include "ocm/transport/bus.hpp"

#include "cli/serve/page_server.hpp"
#include "cli/shared/session.hpp"

namespace ocm::cli::serve {

/// Until a signal comes, or it is over; the exit code. Leaves through `fail` where the bus is gone. The
/// motors rest behind it.
[[nodiscard]] int serve_bus(PageServer& server, Session& session, std::unique_ptr<transport::Bus> bus);

}  // namespace ocm::cli::serve
