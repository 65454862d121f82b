/// What `amiroctl sim` plays of a spec, and at which bit rates: the decisions behind its options.
#pragma once

#include <cstdint>
#include <optional>

#include "cli/shared/session.hpp"

namespace ocm::cli::simulate {

/// What a spec asks to be played.
enum class Cast : std::uint8_t {
  amiro,     ///< the three boards; also without a spec
  messages,  ///< each message at its period
  both,
};

/// Remarks where topics of another robot are left out: no boards of theirs are simulated. Of specs
/// for single interfaces, those of --bus, or of the bus sim, or of the only interface that is named.
[[nodiscard]] Cast cast_of(Session& session);

/// Bit/s.
struct BitRates {
  std::uint32_t nominal = 0;
  std::uint32_t data = 0;
};

/// As typed, else as the spec says, if one is played: the AMiRo's topics may be at another bit rate there;
/// else `usual`. Data go four times as fast where nothing is said, as 2 Mbit/s on a bus of 500 kbit/s.
[[nodiscard]] BitRates bit_rates(std::optional<std::uint32_t> typed, std::optional<std::uint32_t> typed_data,
                                 std::uint32_t usual, Session& session, bool played);

}  // namespace ocm::cli::simulate
