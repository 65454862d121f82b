/// Buses by the names that people give them: can0, slcan:/dev/ttyACM0@500k, sim, sim:PATH.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "ocm/transport/bus.hpp"

namespace ocm::cli {

/// What is behind a name. What names nothing else is a CAN interface.
struct BusName {
  enum class Kind : std::uint8_t { interface, serial, simulated };
  Kind kind = Kind::interface;
  std::string address;  ///< the interface, PATH@RATE, or the simulator's socket (empty: the usual one)
};

[[nodiscard]] BusName parse_bus_name(std::string_view name);

/// Says on stderr what an adapter cannot tell.
[[nodiscard]] transport::Outcome<std::unique_ptr<transport::Bus>> open_bus(const BusName& name);

/// Leaves with a message if the other end of a bus is known not to answer: a simulator that is stopped keeps
/// its clients, and is as silent as a robot at rest. Of other buses nothing is known. Takes up to two
/// seconds.
void expect_answer(std::string_view name);

/// The only interface that is up, or the simulator; leaves with a message where there is none, or several.
[[nodiscard]] std::string only_bus();

}  // namespace ocm::cli
