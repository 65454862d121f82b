/// The messages of a CAN bus as its analyses see them: how long, how often, how late at most.
///
/// A set is in the order of arbitration: the message that wins comes first, so that an index is a priority,
/// unique as identifiers are. Times are ticks of the caller; all of one set and its bus are of the same kind.
/// [Davis, Burns, Bril, Lukkien 2007, section 2]
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/analysis/checked.hpp"
#include "ocm/analysis/verdict.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/fd_bits.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::analysis {

struct Message {
  std::int64_t cost = 0;    ///< C: its longest frame with the intermission; at least 1, and one bit
  std::int64_t period = 0;  ///< T: releases are at least so far apart, but for the jitter; at least 1
  std::int64_t deadline = implicit_deadline;  ///< D, from the release as planned; at least 1
  std::int64_t jitter = 0;                    ///< J: how much later than planned it can be handed over
  std::int64_t offset = 0;                    ///< O: of its first release; for can_offsets.hpp only
  std::uint32_t key = 0;                      ///< can::arbitration_key: what a set is ordered by
  std::uint16_t node = 0;                     ///< who sends it: for queues and offsets

  [[nodiscard]] constexpr std::int64_t due() const noexcept {
    return deadline == implicit_deadline ? period : deadline;
  }
  friend constexpr bool operator==(const Message&, const Message&) = default;
};

/// At most so many faults: `burst` at once, and one more whenever `every` ticks have passed. Each costs an
/// error frame and the repetition of what it hit. [Davis et al. 2007, section 6; Tindell, Burns 1994]
struct ErrorModel {
  std::int64_t burst = 0;  ///< n; at least 1 if there is an `every`
  std::int64_t every = 0;  ///< T_err; 0: none but the burst
};

struct CanBus {
  std::int64_t bit = 1;  ///< tau_bit: how long one bit is
  ErrorModel errors{};
};

/// An error flag, its echo, the delimiter, an intermission, and the 8 bits that an error passive sender
/// waits: the first three would do where C has its intermission and all are error active. [Davis et al. 2007]
inline constexpr std::int64_t error_frame_bits = 31;

/// The first message whose numbers mean nothing; no_index if all do.
[[nodiscard]] constexpr std::size_t first_bad(std::span<const Message> set) noexcept {
  for (std::size_t i = 0; i < set.size(); ++i) {
    const Message& m = set[i];
    if (m.cost < 1 || m.period < 1 || m.jitter < 0 || m.offset < 0 || m.due() < 1) return i;
  }
  return no_index;
}

[[nodiscard]] constexpr bool valid(const CanBus& bus) noexcept {
  return bus.bit >= 0 && bus.errors.burst >= (bus.errors.every > 0 ? 1 : 0) && bus.errors.every >= 0;
}

/// Puts a set into the order of arbitration; equal keys stay as they are. O(n^2) at worst, O(n) if it was.
constexpr void sort_by_key(std::span<Message> set) noexcept {
  for (std::size_t i = 1; i < set.size(); ++i) {
    const Message moved = set[i];
    std::size_t place = i;
    for (; place > 0 && moved.key < set[place - 1].key; --place) set[place] = set[place - 1];
    set[place] = moved;
  }
}

/// The position of the first message that has the key of the one before it; no_index if keys differ, as
/// identifiers must. The set is in order.
[[nodiscard]] constexpr std::size_t first_clash(std::span<const Message> set) noexcept {
  for (std::size_t i = 1; i < set.size(); ++i)
    if (set[i].key == set[i - 1].key) return i;
  return no_index;
}

/// Nanoseconds that `bits` take at a bit rate of at least 1, rounded up: a bound stays one.
[[nodiscard]] constexpr std::int64_t bits_ns(std::int64_t bits, std::uint32_t bit_rate) noexcept {
  return ceil_div(Checked{bits} * 1'000'000'000, std::int64_t{bit_rate}).value_or(unbounded);
}

/// The same of a CAN FD frame, each part at its own bit rate.
[[nodiscard]] constexpr std::int64_t bits_ns(const can::FdBits& bits, std::uint32_t bit_rate,
                                             std::uint32_t data_bit_rate) noexcept {
  return (Checked{bits_ns(std::int64_t{bits.nominal}, bit_rate)} +
          bits_ns(std::int64_t{bits.data}, data_bit_rate))
      .value_or(unbounded);
}

/// A frame of a spec as a message, in nanoseconds.
template <class Frame>
[[nodiscard]] constexpr Message message_of(const Frame& frame, protocol::Direction direction,
                                           protocol::Priority priority, base::Duration period,
                                           base::Duration deadline, base::Duration jitter,
                                           std::uint32_t bit_rate) noexcept {
  Message message;
  message.cost = bits_ns(protocol::worst_bits(frame, priority), bit_rate);
  message.period = period.count();
  if (deadline.count() != 0) message.deadline = deadline.count();
  message.jitter = jitter.count();
  message.key = can::arbitration_key({.id = protocol::Identifier{direction, priority, frame.id}.encode()});
  return message;
}

/// E(t): what errors take in a window of t ticks, if each can hit a frame of `longest`; t is at least 1.
[[nodiscard]] constexpr Checked error_delay(const CanBus& bus, std::int64_t longest, Checked t) noexcept {
  if (bus.errors.burst == 0) return 0;
  Checked count = bus.errors.burst;
  if (bus.errors.every > 0) count += ceil_div(t, bus.errors.every) - 1;
  return count * (Checked{error_frame_bits} * bus.bit + longest);
}

}  // namespace ocm::analysis
