/// Frames that contradict the spec. Identifiers alone do not say whose frames they are: when many are of no
/// topic, or of a length that their topic has not, those that fit may be of another robot, too.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "ocm/measure/statistics.hpp"

namespace ocm::cli {

struct Contradictions {
  std::uint64_t frames = 0;   ///< all that came, without error frames
  std::uint64_t foreign = 0;  ///< of no topic, CAN FD among them
  std::uint64_t wrong_length = 0;
  std::optional<measure::WrongLength> first;  ///< of wrong length
};

/// Says so on stderr when a tenth of the frames or more contradict the spec of `robot`. `guess` is what is
/// said when nearly all do: "a log of another bus?". `beginning` goes before: "can1: ".
void tell_contradictions(const Contradictions& found, std::string_view robot, std::string_view guess,
                         std::string_view beginning = {});

}  // namespace ocm::cli
