/// The 11-bit identifier: who speaks to whom, how urgent, about what. [Thesis 4.1, figure 4.1]
///
///     bit 10   C/S       0 command or actuator, 1 sensor or status
///     bit 9..8 priority  0 urgent, 1 high, 2 medium, 3 low
///     bit 7..0 topic
///
/// A lower identifier wins the bus: commands before sensor data, urgent before low.
#pragma once

#include <cstdint>
#include <string_view>

#include "ocm/base/result.hpp"
#include "ocm/can/frame.hpp"

namespace ocm::protocol {

/// A topic's number. A type of its own, so that it is never mixed up with an identifier or a length.
struct TopicId {
  std::uint8_t value = 0;
  constexpr TopicId() = default;
  constexpr explicit TopicId(std::uint8_t v) noexcept : value(v) {}
  friend constexpr auto operator<=>(TopicId, TopicId) = default;
};

enum class Direction : std::uint8_t {
  command = 0,  ///< to a board: a request to a sensor, or an actuator's set point
  sensor = 1,   ///< from a board: sensor data or status
};

enum class Priority : std::uint8_t { urgent = 0, high = 1, medium = 2, low = 3 };
inline constexpr Priority default_priority = Priority::medium;
inline constexpr std::size_t priority_levels = 4;

[[nodiscard]] constexpr std::string_view name(Priority priority) noexcept {
  constexpr std::string_view names[] = {"urgent", "high", "medium", "low"};
  return names[static_cast<std::uint8_t>(priority) & 3];
}

[[nodiscard]] constexpr base::Result<Priority> parse_priority(std::string_view text) noexcept {
  for (const auto p : {Priority::urgent, Priority::high, Priority::medium, Priority::low})
    if (text == name(p)) return p;
  return base::Error::bad_syntax;
}

/// The bits that direction and topic have: identifiers that agree in them differ in priority only. For
/// acceptance filters.
inline constexpr std::uint16_t topic_mask = 0x4FF;

struct Identifier {
  Direction direction = Direction::command;
  Priority priority = default_priority;
  TopicId topic{};

  [[nodiscard]] constexpr std::uint16_t encode() const noexcept {
    return static_cast<std::uint16_t>(static_cast<unsigned>(direction) << 10 |
                                      static_cast<unsigned>(priority) << 8 | topic.value);
  }
  /// Every number of 11 bits is an identifier; higher bits are cut off.
  [[nodiscard]] static constexpr Identifier decode(std::uint32_t id) noexcept {
    return {static_cast<Direction>(id >> 10 & 1), static_cast<Priority>(id >> 8 & 3),
            TopicId{static_cast<std::uint8_t>(id)}};
  }
  friend constexpr bool operator==(const Identifier&, const Identifier&) = default;
};

}  // namespace ocm::protocol
