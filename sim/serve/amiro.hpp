/// A simulated AMiRo beside the user: its three boards, compiled for this machine or as images in QEMU, in
/// one world, on a virtual bus or on a CAN interface.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ocm/topics/amiro.hpp"
#include "ocm/transport/bus.hpp"

#include "sim/amiro/world.hpp"
#include "sim/messages/player.hpp"
#include "sim/serve/shell.hpp"

namespace ocm::sim {

struct AmiroOptions {
  WorldOptions world;
  std::vector<std::string> without;  ///< names of boards that are switched off
  bool qemu = false;
  std::string images;  ///< the folder of those for QEMU; empty: where they are expected
  std::uint32_t bit_rate = amiro::bit_rate;
  std::uint32_t data_bit_rate = 0;  ///< of CAN FD frames of others; 0: `bit_rate`
  double bus_errors = 0;            ///< bits a second that nodes see wrong, on average
  double speed = 1;
  /// Whose messages other nodes send on the robot's virtual bus; it must outlive the simulation.
  const protocol::Catalogue* messages = nullptr;
  base::Duration sporadic{};  ///< PlayOptions::sporadic
};

/// The boards and any number of programs on a virtual bus, whose socket is `path`; empty: that of the user.
/// Reports what was sent and what was lost, by cause, when it is stopped.
[[nodiscard]] Ending serve_amiro(const std::string& path, const AmiroOptions& options, const Shell& shell);

/// The boards on a real CAN interface: the kernel is the bus. In real time, without disturbances.
[[nodiscard]] Ending serve_amiro(transport::Bus& bus, const AmiroOptions& options, const Shell& shell);

}  // namespace ocm::sim
