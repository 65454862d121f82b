/// What the server says of robot and bus besides samples: each is one JSON object, the newest of a channel
/// /ocm/NAME. Pure.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/client/diagnosis.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/bus_model/models.hpp"
#include "cli/bus_model/playing.hpp"
#include "cli/serve/channels.hpp"

namespace ocm::spec {
struct Model;
}

namespace ocm::cli::serve {

/// Where the server's frames come from.
struct Source {
  std::string name;  ///< "sim", "drive.log"
  bool live = true;
  bool commands = false;  ///< are taken from who shows the token
};

/// Once: boards, and each channel's topic with its role, fields, units, ranges and names of values; of a
/// ring its geometry, which only the spec has.
[[nodiscard]] std::string robot_state(const protocol::Catalogue& catalogue, const spec::Model& model,
                                      const Channels& channels, const Source& source);

/// What the server has to say of itself.
struct ServerFigures {
  std::size_t viewers = 0;
  std::uint64_t lost = 0;     ///< messages, of viewers that are too slow
  std::uint64_t refused = 0;  ///< requests and connections
};
/// Load and counters of each bus, and a row a topic, message and unknown identifier of which something came.
[[nodiscard]] std::string bus_state(std::span<const bus_model::Bus> buses, base::Time now,
                                    const ServerFigures& figures);
/// As `doctor` sees them, of what the boards say unasked.
[[nodiscard]] std::string boards_state(const protocol::Catalogue& catalogue,
                                       const client::Diagnosis& diagnosis,
                                       const client::StatusRequests& asked,
                                       std::span<const client::Finding> findings);
/// Where a log is. `jumps`: how often it was wound: what a viewer has of before does not go on.
[[nodiscard]] std::string playback_state(const bus_model::Playing& playing, bool paused, std::uint64_t jumps);

}  // namespace ocm::cli::serve
