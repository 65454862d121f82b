/// The set of messages that a log itself shows: which topics are in it, and how often they are due.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "ocm/protocol/topic.hpp"

#include "cli/analyse/arrivals.hpp"
#include "cli/analyse/meter.hpp"
#include "cli/analyse/set.hpp"

namespace ocm::cli::analyse {

/// The releases of what is not sent by its sender's clock, by the key of arbitration. A period of 0 is the
/// set's.
struct Pace {
  Grid grid = Grid::of_sender;
  std::int64_t period = 0;  ///< nanoseconds
};
using Paces = std::map<std::uint32_t, Pace>;

/// The topics that are in the log, with the periods that requests in it ask for, and all messages: they are
/// sent unasked, and one that is missing is a finding. `given` goes before what the log shows. Leaves through
/// cli::fail where the log has no frame of any topic.
[[nodiscard]] BusSet seen_set(const Arrivals& log, const protocol::Catalogue& catalogue,
                              const spec::Model* model, std::vector<Rate> given, Paces& paces);

}  // namespace ocm::cli::analyse
