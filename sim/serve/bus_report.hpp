/// What a simulator says at its end of its virtual bus.
#pragma once

#include <fmt/format.h>

#include "ocm/client/counted.hpp"
#include "ocm/simulation/virtual_bus_server.hpp"

#include "sim/serve/shell.hpp"

namespace ocm::sim {

/// `disturbed`: there was interference, which is counted.
inline void report_bus(const simulation::VirtualBusServer& server, bool disturbed, const Shell& shell) {
  const auto& bus = server.arbiter().totals();
  const auto& clients = server.counters();
  shell.report(fmt::format("bus               {}, {}, {} turned away, {} misbehaved, {} lost by slow ones",
                           client::counted(bus.frames, "frame"), client::counted(clients.welcomed, "client"),
                           clients.turned_away, clients.misbehaved,
                           client::counted(clients.overruns, "frame")));
  if (disturbed)
    shell.report(fmt::format("                  {}, {} repeated", client::counted(bus.errors, "error frame"),
                             client::counted(bus.repetitions, "frame")));
  if (bus.clashes != 0)
    shell.report(fmt::format("                  {} two senders at once with the same identifier",
                             client::counted(bus.clashes, "time")));
}

}  // namespace ocm::sim
