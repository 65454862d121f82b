/// Which message should go first: orders in which every message meets its deadline, if there are any.
///
/// Free identifiers: Audsley's algorithm, from the least urgent level up. Deadline monotonic order is not
/// optimal on CAN; this is. [Audsley 1991; Davis, Burns, Bril, Lukkien 2007, section 5]
///
/// Identifiers in this library's layout: direction and topic are given, and only the two bits of priority can
/// be chosen. All begin at low, and a message that misses goes up by one, until none misses or one does at
/// urgent. That is optimal, too: a message that moves down takes away from those above it at least as much
/// interference as it can add in blocking. So a message that misses while no message is above its place in an
/// order that works must itself be below its own, and no step goes past any order that works. What is found
/// is the least urgent one.
///
/// Cost: one analysis of the set (can_response.hpp) for each order that is tried: up to n^2 / 2 for free
/// identifiers, about n where deadline monotonic order is nearly right; up to 3 n + 1 in the layout.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/analysis/can_response.hpp"
#include "ocm/analysis/message_set.hpp"
#include "ocm/analysis/verdict.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/protocol/identifier.hpp"

namespace ocm::analysis {

/// Puts the set into an order in which each message meets its deadline. Returns no_index; or the lowest
/// level, from 0 for the most urgent, which none of the messages from there up can take: then there is no
/// such order, what stands below that level stays there, and the rest is deadline monotonic. bad_input: the
/// last level.
template <std::size_t N>
constexpr std::size_t assign_priorities(std::span<Message> set, const CanBus& bus,
                                        CanResponse<N>& analysis) noexcept {
  if (set.empty()) return no_index;
  if (set.size() > N || first_bad(set) != no_index || !valid(bus)) return set.size() - 1;
  // By D - J: mostly the last one fits.
  for (std::size_t i = 1; i < set.size(); ++i)
    for (std::size_t k = i; k > 0 && set[k].due() - set[k].jitter < set[k - 1].due() - set[k - 1].jitter; --k)
      std::swap(set[k], set[k - 1]);
  for (std::size_t level = set.size(); level-- > 0;) {
    std::size_t tried = level + 1;
    while (tried > 0) {
      --tried;
      std::rotate(set.begin() + static_cast<std::ptrdiff_t>(tried),
                  set.begin() + static_cast<std::ptrdiff_t>(tried) + 1,
                  set.begin() + static_cast<std::ptrdiff_t>(level) + 1);
      if (analysis.analyse(set, bus)[level].ok()) break;
      std::rotate(set.begin() + static_cast<std::ptrdiff_t>(tried),
                  set.begin() + static_cast<std::ptrdiff_t>(level),
                  set.begin() + static_cast<std::ptrdiff_t>(level) + 1);
      if (tried == 0) return level;
    }
  }
  return no_index;
}

/// A message in the identifier layout. Its `key` follows from the rest.
struct TopicMessage {
  Message message{};  ///< its cost: the greatest over the priorities
  protocol::Direction direction = protocol::Direction::sensor;
  protocol::TopicId topic{};
  protocol::Priority priority = protocol::Priority::low;

  [[nodiscard]] constexpr std::uint16_t identifier() const noexcept {
    return protocol::Identifier{direction, priority, topic}.encode();
  }
};

/// Gives each message the least urgent priority with which all meet their deadlines, and sorts the set by
/// identifier. Returns no_index; or the position of a message that misses though it is urgent, while all that
/// could be below it are: then no choice of priorities works. A set that cannot be analysed: position 0.
template <std::size_t N>
constexpr std::size_t assign_in_layout(std::span<TopicMessage> set, const CanBus& bus,
                                       CanResponse<N>& analysis) noexcept {
  if (set.empty()) return no_index;
  if (set.size() > N) return 0;
  for (TopicMessage& m : set) m.priority = protocol::Priority::low;
  std::array<Message, N> messages{};
  for (;;) {
    for (std::size_t i = 1; i < set.size(); ++i)
      for (std::size_t k = i; k > 0 && set[k].identifier() < set[k - 1].identifier(); --k)
        std::swap(set[k], set[k - 1]);
    for (std::size_t i = 0; i < set.size(); ++i) {
      set[i].message.key = can::arbitration_key({.id = set[i].identifier()});
      messages[i] = set[i].message;
    }
    const auto results = analysis.analyse({messages.data(), set.size()}, bus);
    if (results[0].reason == Reason::bad_input) return 0;
    bool changed = false;
    for (std::size_t i = 0; i < set.size(); ++i) {
      if (results[i].ok()) continue;
      if (set[i].priority == protocol::Priority::urgent) return i;
      set[i].priority = static_cast<protocol::Priority>(static_cast<unsigned>(set[i].priority) - 1);
      changed = true;
    }
    if (!changed) return no_index;
  }
}

}  // namespace ocm::analysis
