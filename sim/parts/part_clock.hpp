/// The clock of the models of parts: turn-on times and write cycles go by it. It is not the world's, whose
/// time may be frozen.
#pragma once

#include <functional>

#include "ocm/base/time.hpp"

namespace ocm::sim {

using PartClock = std::function<base::Time()>;

}  // namespace ocm::sim
