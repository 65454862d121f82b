/// What a viewer asks of robots behind a central: an object on the channel of the fleet. Pure.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "ocm/base/result.hpp"
#include "ocm/motion/pose.hpp"

namespace ocm::cli::serve {

/// The channel of the fleet, on which orders are published, too.
inline constexpr std::string_view fleet_topic = "/ocm/fleet";

struct FleetOrder {
  enum class Kind : std::uint8_t {
    go,         ///< to `place`
    stop,       ///< at once; never refused
    pause,      ///< it sends no more updates, until it goes on
    go_on,      ///< behind a pause, or where an owner that explores holds it
    call_back,  ///< straight to where it was switched on
    look,       ///< for robots, and link them
  };
  Kind kind = Kind::stop;
  std::string robot{};    ///< its name, or its index on the list
  motion::Point place{};  ///< in the map
};

/// {"robot":"AVR","x_m":1.2,"y_m":0.4}, {"robot":0,"order":"stop"}, {"order":"look"}. The error says what is
/// wrong, and what would be right.
[[nodiscard]] base::Result<FleetOrder, std::string> fleet_order_of(std::string_view payload);

}  // namespace ocm::cli::serve
