/// The time of a central's line: of all programs of this machine the same, as the rows between them need.
#pragma once

#include "ocm/base/time.hpp"

#include "cli/shared/clock.hpp"

namespace ocm::cli::fleet {

[[nodiscard]] inline base::Time line_time() noexcept {
  return base::Time{Clock::now().time_since_epoch()};
}

}  // namespace ocm::cli::fleet
