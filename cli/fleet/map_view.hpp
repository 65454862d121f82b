/// Draws the map that another program draws with its robots, again and again while it grows.
#pragma once

#include <memory>

#include "cli/fleet/joined_line.hpp"
#include "cli/fleet/map_run.hpp"

namespace ocm::cli::fleet {

/// Writes the files of `options` each two seconds, until the other program ends, for --duration, or until a
/// signal comes. Returns the exit code; ends the command where the other program draws no map.
[[nodiscard]] int view_map(const MapOptions& options, JoinedLine& line);

}  // namespace ocm::cli::fleet
