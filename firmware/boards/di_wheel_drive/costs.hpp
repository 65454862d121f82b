/// What DiWheelDrive's samples and tasks take of its processor, for its admission: its set of
/// spec/tasks.json, which is schedulable as long as no request asks for more than the defaults.
#pragma once

#include "ocm/analysis/task_list.hpp"
#include "ocm/analysis/task_sets.hpp"

#include "firmware/boards/bus.hpp"  // the proof for the bus, beside that for the processor
#include "firmware/boards/di_wheel_drive/board.hpp"

namespace ocm::firmware::boards::di_wheel_drive {

namespace task_set = analysis::task_sets::di_wheel_drive;
static_assert(analysis::schedulable<task_set::Facts::Tasks>);

static_assert(task_set::Control::task.period == control_period.count());
static_assert(task_set::DeadReckoning::task.period == odometry_period.count());
static_assert(task_set::Behaviours::task.period == behaviour_period.count());

using Costs = analysis::CostsOf<task_set::Facts>;
static_assert(analysis::admits_defaults<amiro::DiWheelDrive, amiro::bit_rate, Costs>(),
              "the board refuses one of its sensors where all are asked for at their defaults");

}  // namespace ocm::firmware::boards::di_wheel_drive
