/// What a verb waits for: that a robot has paused, or goes on.
#pragma once

#include "cli/fleet/central_line.hpp"

namespace ocm::cli::fleet {

/// Says it again each half second, for at most ten. Whether it obeys; a signal ends the command.
[[nodiscard]] bool pause_until_seen(CentralLine& line, unsigned index, bool paused);
/// Said three times, where no time is left to see that it obeys.
void pause_unseen(CentralLine& line, unsigned index);

/// A robot that is heard, but of which not even a piece of an update comes. Listens for at most 2.5 s.
[[nodiscard]] bool seems_paused(CentralLine& line, unsigned index);

}  // namespace ocm::cli::fleet
