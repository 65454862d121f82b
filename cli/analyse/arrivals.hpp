/// The frames of a log as the analysis needs them: when each ended, and what it took on the bus.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "ocm/can/fd_bits.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::cli::analyse {

struct Arrival {
  std::int64_t time = 0;  ///< nanoseconds
  can::FdBits bits;       ///< with its stuff bits and the intermission
  std::uint8_t length = 0;
  can::Frame frame;  ///< of CAN FD without its data
};

struct Arrivals {
  std::vector<Arrival> all;  ///< in the order of time; at least one
  std::size_t errors = 0;    ///< error frames
  std::vector<std::string> remarks;
};

/// Of the log's first interface. Leaves through cli::fail where it has no frame, or something in it cannot be
/// read.
[[nodiscard]] Arrivals read_arrivals(const std::string& file, const protocol::Catalogue& catalogue);

}  // namespace ocm::cli::analyse
