/// The four levels that preempt each other. Each has a context of its own: a level runs only while no more
/// urgent one can. What a level means on a processor or an RTOS is the port's (port.hpp).
#pragma once

#include <cstddef>
#include <cstdint>

namespace ocm::scheduling {

enum class Level : std::uint8_t {
  urgent = 0,  ///< preempts all others: what must not be late, such as a control loop or a watchdog
  high = 1,    ///< preempts medium and low
  medium = 2,  ///< preempts low: where a request does not say otherwise
  low = 3,     ///< runs when no other level has anything to do
};

inline constexpr std::size_t level_count = 4;
inline constexpr Level default_level = Level::medium;

}  // namespace ocm::scheduling
