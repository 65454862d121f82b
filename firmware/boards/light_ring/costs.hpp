/// What LightRing's samples and tasks take of its processor, for its admission: its set of spec/tasks.json,
/// which is schedulable as long as no request asks for more than the defaults.
#pragma once

#include "ocm/analysis/task_list.hpp"
#include "ocm/analysis/task_sets.hpp"

#include "firmware/boards/bus.hpp"  // the proof for the bus, beside that for the processor

namespace ocm::firmware::boards::light_ring {

namespace task_set = analysis::task_sets::light_ring;
static_assert(analysis::schedulable<task_set::Facts::Tasks>);

using Costs = analysis::CostsOf<task_set::Facts>;
static_assert(analysis::admits_defaults<amiro::LightRing, amiro::bit_rate, Costs>(),
              "the board refuses one of its sensors where all are asked for at their defaults");

}  // namespace ocm::firmware::boards::light_ring
