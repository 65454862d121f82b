/// Simulated mappers beside the user: in a world, behind a central whose serial line is a pseudo terminal, or
/// each on a line of its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "sim/serve/shell.hpp"

namespace ocm::sim {

struct MapperOptions {
  std::size_t robots = 0;  ///< 0: as many as the world has
  std::string world;       ///< a file, or the name of one that is built in; empty: "square"
  std::uint64_t seed = 1;
  double speed = 1;
  bool lines = false;         ///< no central: each robot on a line of its own
  double radio_loss = 0;      ///< share of packets lost everywhere
  double radio_range = 0;     ///< metres; 0: the world's
  bool repeats = false;       ///< the radio repeats lost packets
  bool uncalibrated = false;  ///< no compass was ever calibrated
  std::size_t links = 0;      ///< at once; 0: as many as robots
};

/// Until `shell.stop`; reports then what was sent and what was lost, by cause. A world that cannot be read
/// ends with all its problems.
[[nodiscard]] Ending serve_mappers(const MapperOptions& options, const Shell& shell);

}  // namespace ocm::sim
