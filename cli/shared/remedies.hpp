/// What to do about a failure or a finding with this tool: where the library's sentence can be bettered by
/// one that names a verb or an option. Otherwise the library's own.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "ocm/client/diagnosis.hpp"
#include "ocm/client/refusals.hpp"
#include "ocm/client/sample.hpp"
#include "ocm/host/failure.hpp"
#include "ocm/transport/bus.hpp"

namespace ocm::cli {

[[nodiscard]] std::string remedy(const host::Failure& failure);
[[nodiscard]] std::string remedy(const client::Finding& finding);
/// What was counted while this program listened, a warning for each counter that is not zero.
[[nodiscard]] std::vector<client::Finding> findings_of(const transport::BusCounters& bus,
                                                       const client::ReceiverCounters& seen);
/// Where a behaviour that goes by the ring has no sample of it: a board that was just flashed has none.
inline constexpr std::string_view ring_without_offsets =
    "has the ring its offsets? With nothing around the robot: `amiroctl set ring_calibration "
    "action=measure`; "
    "`amiroctl doctor` shows which parts do not answer";
/// What the board would accept.
[[nodiscard]] std::string remedy(const client::Refused& refused);
/// A board's reason, by its name in the spec and in words.
[[nodiscard]] std::string describe(const client::Refused& refused);

}  // namespace ocm::cli
