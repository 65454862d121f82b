/// `sim --robots`: mappers in a world, in real time, for programs of this user: behind a central, whose
/// serial line is a pseudo terminal, or each on a line of its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace ocm::cli {

struct MapperOptions {
  std::size_t robots = 0;  ///< 0: as many as the world has
  std::string world;       ///< a file, or the name of one that is built in; empty: "square"
  std::uint64_t seed = 1;
  double speed = 1;
  bool lines = false;      ///< no central: each robot on a line of its own
  double radio_loss = 0;   ///< share of packets lost everywhere
  double radio_range = 0;  ///< metres; 0: the world's
  bool repeats = false;    ///< the radio repeats lost packets
  std::size_t links = 0;   ///< at once; 0: as many as robots
};

/// Until a signal comes; tells at its end what was sent and what was lost, by cause.
void simulate_mappers(const MapperOptions& options);

}  // namespace ocm::cli
