/// What a program asks of the one that has a central's line: a request is one message of words
/// (cli/shared/local_link.hpp). docs/cognitive.md lists them.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "ocm/base/time.hpp"
#include "ocm/mapper/link/sentences.hpp"

namespace ocm::cli::fleet {

/// A central that looks for robots says nothing to those that it has, and all other programs wait for it.
inline constexpr std::chrono::seconds longest_scan{60};

struct LineRequest {
  enum class Kind : std::uint8_t {
    robots,     ///< `robots [FROM]`: a row a robot, from this index on
    json,       ///< `json [FROM]`: the same for other programs, an object a robot
    scan,       ///< `scan MS`: list robots, behind a scan of so long
    connect,    ///< `connect ROBOT`
    go,         ///< `go ROBOT ANGLE DISTANCE`: degrees, cm
    stop,       ///< `stop ROBOT`
    leave,      ///< `leave ROBOT`: its drive goes on without who asked for it
    pause,      ///< `pause ROBOT`
    unpause,    ///< `unpause ROBOT`
    ping,       ///< `ping ROBOT`
    who,        ///< `who ROBOT`: asks it for its handshake
    calibrate,  ///< `calibrate ROBOT`
    compass,    ///< `compass ROBOT`: how its last calibration ended
    map,        ///< `map svg`, or png, pdf, pgm, yaml, grid: the map so far, as a file's text
    more,       ///< `more OFFSET`: the rest of that
  };
  Kind kind = Kind::robots;
  unsigned robot = 0;  ///< its index on the list
  mapper::link::SetPoint set_point{};
  base::Duration time{};
  std::uint64_t offset = 0;
  std::string_view form{};  ///< of a map; in the request's text
};

/// Nothing: no such request, or a number that is none or out of its range.
[[nodiscard]] std::optional<LineRequest> parse_line_request(std::string_view text);

}  // namespace ocm::cli::fleet
