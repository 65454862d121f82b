/// What a simulator says at its end of its virtual bus.
#pragma once

#include <fmt/format.h>

#include "ocm/simulation/virtual_bus_server.hpp"

#include "sim/serve/shell.hpp"

namespace ocm::sim {

/// `disturbed`: there was interference, which is counted.
inline void report_bus(const simulation::VirtualBusServer& server, bool disturbed, const Shell& shell) {
  const auto& bus = server.arbiter().totals();
  const auto& clients = server.counters();
  shell.report(fmt::format(
      "bus               {} frames, {} clients, {} turned away, {} misbehaved, {} frames lost by slow ones",
      bus.frames, clients.welcomed, clients.turned_away, clients.misbehaved, clients.overruns));
  if (disturbed)
    shell.report(
        fmt::format("                  {} error frames, {} frames repeated", bus.errors, bus.repetitions));
  if (bus.clashes != 0)
    shell.report(
        fmt::format("                  {} times two senders at once with the same identifier", bus.clashes));
}

}  // namespace ocm::sim
