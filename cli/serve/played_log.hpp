/// `serve` of a log: its frames to the page as time goes on, wound by viewers' time bars.
#pragma once

#include "cli/bus_model/feed.hpp"
#include "cli/serve/page_server.hpp"

namespace ocm::cli::serve {

/// Until a signal comes, or it is over; the exit code. At its end a log stays where it is.
[[nodiscard]] int serve_log(PageServer& server, bus_model::LogFeed& log);

}  // namespace ocm::cli::serve
