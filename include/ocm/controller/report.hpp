/// What a board says of itself: how its status and its refusals are filled. The controller serves both topics
/// wherever the spec has them (roles status and refusal); a board adds what only it knows.
#pragma once

#include <algorithm>
#include <chrono>
#include <concepts>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/protocol/identifier.hpp"

namespace ocm::controller {

/// What became of a command frame.
struct Verdict {
  bool mine = false;  ///< the frame is for one of these topics
  base::Error refused = base::Error::none;
  friend constexpr bool operator==(const Verdict&, const Verdict&) = default;
};

/// What a controller cannot know of its board. Numbers are those of the spec's status topic.
struct Health {
  static constexpr std::uint8_t unknown_load = 255;
  std::uint8_t reset = 0;            ///< why the board started; 0: unknown
  std::uint8_t load = unknown_load;  ///< of the CPU, percent
  std::uint8_t bus = 0;              ///< state of the CAN controller; 0: error active
  std::uint32_t bus_errors = 0;      ///< that the CAN controller has counted
  std::uint32_t line_lost = 0;       ///< frames and characters of a host on the board's serial line
  friend constexpr bool operator==(const Health&, const Health&) = default;
};

/// What a controller knows.
struct Activity {
  base::Duration uptime{};
  std::uint32_t wire_hash = 0;
  std::uint32_t publishing = 0;  ///< bit n: the board's n-th sensor
  std::uint32_t faults = 0;      ///< the same
  std::uint64_t overload = 0;
  std::uint32_t send_failed = 0;  ///< samples given up
};

struct Refusal {
  protocol::TopicId topic{};
  base::Error reason = base::Error::none;
  friend constexpr bool operator==(const Refusal&, const Refusal&) = default;
};

namespace detail {
/// The number, or the greatest that the field's type holds; its frame's width bounds it once more.
template <class T>
[[nodiscard]] constexpr T saturated(std::uint64_t number) noexcept {
  if constexpr (std::is_enum_v<T>)
    return static_cast<T>(number);
  else
    return static_cast<T>(std::min<std::uint64_t>(number, std::numeric_limits<T>::max()));
}
template <class T>
constexpr void put(T& field, std::uint64_t number) noexcept {
  field = saturated<T>(number);
}
}  // namespace detail

/// `Status`: a generated topic with the role status.
template <class Status>
[[nodiscard]] constexpr Status make_status(const Health& health, const Activity& activity) noexcept {
  using detail::put;
  Status status;
  put(status.identity.uptime, static_cast<std::uint64_t>(activity.uptime / std::chrono::seconds{1}));
  put(status.identity.reset, health.reset);
  put(status.identity.wire_hash, activity.wire_hash);
  put(status.health.load, health.load);
  put(status.health.bus, health.bus);
  put(status.health.publishing, activity.publishing & 0xFFU);
  put(status.health.faults, activity.faults & 0xFFU);
  put(status.health.overload, activity.overload);
  put(status.health.bus_errors, std::uint64_t{health.bus_errors} + activity.send_failed);
  return status;
}

/// `Topic`: a generated topic with the role refusal.
template <class Topic>
[[nodiscard]] constexpr Topic make_refusal(const Refusal& last, std::uint32_t refused,
                                           std::uint32_t not_sampled, const Health& health) noexcept {
  using detail::put;
  Topic topic;
  put(topic.topic, last.topic.value);
  put(topic.reason, static_cast<std::uint64_t>(last.reason));
  put(topic.refused, refused);
  if constexpr (requires { topic.not_sampled; }) put(topic.not_sampled, not_sampled);
  if constexpr (requires { topic.line_lost; }) put(topic.line_lost, health.line_lost);
  return topic;
}

}  // namespace ocm::controller
