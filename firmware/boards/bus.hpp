/// The robot's bus, proven: whatever all boards send at the periods and priorities of spec/topics.json, and
/// the set points for the motors, the operator's and PowerManagement's, is on the wire before its deadline
/// and before the next sample. A topic that the spec makes too fast stops every board's image here. The
/// compiler names the first frame that is late, which can be another one than the fast one:
/// misses_its_deadline<FreshFrame<amiro::ProximityRing, ...>, response, deadline>, in nanoseconds.
///
/// Not in it, since they are not sent by the clock: requests, the lights' set points, calibrations; nor what
/// is asked for beyond the spec's periods, which admission decides (docs/admission.md). `amiroctl analyse
/// bus` shows the same set as a table.
///
/// Nothing at run time; compiling takes some 0.05 s longer.
#pragma once

#include <chrono>
#include <cstddef>

#include "ocm/analysis/message_set.hpp"
#include "ocm/analysis/schedulable.hpp"
#include "ocm/analysis/task_sets.hpp"
#include "ocm/base/time.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/topics/amiro.hpp"

#include "firmware/boards/avoidance.hpp"

namespace ocm::firmware::boards {

/// The operator repeats a set point so often: five may be lost before the motors stop by themselves.
inline constexpr base::Duration set_point_period = amiro::Motors::timeout / 5;

/// What PowerManagement commands while it avoids obstacles: released at the end of its task.
struct AvoidanceSetPoint {
  static constexpr analysis::Message message = [] {
    using Task = analysis::task_sets::power_management::Avoidance;
    constexpr auto& tasks = analysis::task_sets::power_management::Facts::Tasks::results;
    constexpr std::size_t first = 0;
    static_assert(analysis::task_sets::power_management::Facts::Tasks::item<first>::name == Task::name);
    static_assert(avoidance_period.count() == Task::task.period);
    return analysis::message_of(amiro::Motors::frames[0], protocol::Direction::command, avoidance_priority,
                                avoidance_period, amiro::Motors::deadline,
                                base::Duration{tasks[first].response}, amiro::bit_rate);
  }();
};

using Bus = decltype(
    analysis::SentBy<amiro::bit_rate, amiro::DiWheelDrive, amiro::PowerManagement, amiro::LightRing>{} +
    analysis::Traffic<analysis::bits_ns(1, amiro::bit_rate),
                      analysis::FreshFrame<amiro::Motors, amiro::bit_rate, 0, 1, set_point_period.count()>,
                      AvoidanceSetPoint>{});
/// Its place in `Bus::results`.
inline constexpr std::size_t avoidance_on_bus = Bus::size - 1;

static_assert(analysis::schedulable<Bus>, "the boards send more than the bus takes: see spec/topics.json");

/// Frames of the spec's sensors, whatever board they are of.
static_assert(
    Bus::size == 2 +
                     [] {
                       std::size_t frames = 0;
                       for (const protocol::Topic& topic : amiro::catalogue.topics)
                         if (topic.kind == protocol::Kind::sensor) frames += topic.frames.size();
                       return frames;
                     }(),
    "a board of the spec is not in this set");

}  // namespace ocm::firmware::boards
