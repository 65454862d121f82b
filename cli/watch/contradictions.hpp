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

/// Where the frames came from, which says what else they may be.
enum class Seen : std::uint8_t { live, in_log };

/// Says so on stderr when a tenth of the frames or more contradict the spec, in the words of what it has:
/// topics, messages or both. `beginning` goes before: "can1: ".
void tell_contradictions(const Contradictions& found, const protocol::Catalogue& catalogue, Seen where,
                         std::string_view beginning = {});

}  // namespace ocm::cli
