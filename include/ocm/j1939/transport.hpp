/// The transport protocol of SAE J1939-21 as a listener hears it: messages of 9 to 1785 bytes, which go as
/// packets of seven, put together again. It never answers, so it can listen beside the nodes that do.
///
///     TP.CM, group EC00   16 RTS, 17 CTS, 19 EndOfMsgACK, 32 BAM, 255 Abort
///     TP.DT, group EB00   a number from 1, then seven bytes
///
/// A source has one broadcast (BAM) at a time, and one connection (RTS) with each destination. A message
/// comes out only when every packet came in its order; a packet that the receiver asks for again is taken
/// again. All other ends are counted, each by its cause:
///
///     announced == complete + lost_packet + wrong_sequence + aborted + timed_out + replaced + open()
///
/// Time is handed in. Memory: 1.9 KiB a session; O(sessions) a frame of the protocol, no heap.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/base/time.hpp"
#include "ocm/j1939/identifier.hpp"

namespace ocm::j1939 {

inline constexpr std::uint32_t connection_group = 0xEC00;  ///< TP.CM
inline constexpr std::uint32_t transfer_group = 0xEB00;    ///< TP.DT
inline constexpr std::size_t least_transported = 9;
inline constexpr std::size_t most_transported = 1785;  ///< 255 packets of seven
inline constexpr std::size_t bytes_a_packet = 7;

/// Packets that a message of so many bytes takes.
[[nodiscard]] constexpr std::uint32_t packets_of(std::size_t bytes) noexcept {
  return static_cast<std::uint32_t>((bytes + bytes_a_packet - 1) / bytes_a_packet);
}

/// How long the next frame of a session may take. [SAE J1939-21, 5.10.2.4 and C.1]
namespace timeout {
using namespace std::chrono_literals;
inline constexpr base::Duration t1 = 750ms;   ///< from a packet to the next
inline constexpr base::Duration t2 = 1250ms;  ///< from CTS to the packet
inline constexpr base::Duration t3 = 1250ms;  ///< from RTS or the last packet asked for to CTS
inline constexpr base::Duration t4 = 1050ms;  ///< from a CTS that says "wait" to the next
}  // namespace timeout

/// Whether an identifier of 29 bits is the protocol's.
[[nodiscard]] constexpr bool is_transport(std::uint32_t id) noexcept {
  // Both groups go to one address: EBxx and ECxx.
  const std::uint32_t group = id >> 16 & 0x3FF;
  return group == transfer_group >> 8 || group == connection_group >> 8;
}

/// What a frame turned out to be.
enum class Heard : std::uint8_t {
  control,  ///< a frame of TP.CM
  packet,   ///< seven bytes of a message
  message,  ///< the packet that completes one
  nothing,  ///< another group's frame, or no frame that the protocol has: counted
};

struct TransportCounters {
  std::uint32_t announced = 0;  ///< messages for which there was a session
  std::uint32_t complete = 0;
  std::uint32_t lost_packet = 0;     ///< a number was left out, and not requested again
  std::uint32_t wrong_sequence = 0;  ///< a number that the message has not, or that was not requested again
  std::uint32_t aborted = 0;
  std::uint32_t timed_out = 0;
  std::uint32_t replaced = 0;    ///< its source announced the next before the end
  std::uint32_t no_session = 0;  ///< announced while all sessions were taken
  std::uint32_t bad_size = 0;    ///< announced with less than 9, more than 1785, or another number of packets
  std::uint32_t stray = 0;       ///< packets of no message: listening began in its middle
  std::uint32_t malformed = 0;   ///< frames that the protocol has not
  /// Messages that were there and did not come out.
  [[nodiscard]] constexpr std::uint32_t lost() const noexcept {
    return lost_packet + wrong_sequence + aborted + timed_out + replaced + no_session + bad_size;
  }
};

/// A message that was put together.
struct Transported {
  Identifier id{};  ///< of the message itself; its priority is that of the packets
  /// Valid until the next frame is taken; behind it eight bytes may be read.
  std::span<const std::uint8_t> data{};
};

template <std::size_t Sessions>
class Transport {
  static_assert(Sessions > 0);

 public:
  /// `channel` tells buses apart, each of which has its own addresses.
  Heard take(std::uint32_t id, std::span<const std::uint8_t> data, base::Time now,
             std::uint16_t channel = 0) noexcept {
    if (!is_transport(id)) return Heard::nothing;
    expire(now);
    const Identifier from = Identifier::decode(id);
    if (data.size() != 8) return refuse();
    return from.pgn == transfer_group ? take_packet(from, data, now, channel)
                                      : take_control(from, data, now, channel);
  }
  /// The message that `take` said to be whole.
  [[nodiscard]] const Transported& message() const noexcept { return message_; }

  /// Ends the sessions of which nothing came in time. Only needed for counters at rest.
  void expire(base::Time now) noexcept {
    for (Session& session : sessions_)
      if (session.state != State::free && now > session.deadline) end(session, counters_.timed_out);
  }
  /// Messages under way.
  [[nodiscard]] std::size_t open() const noexcept {
    return static_cast<std::size_t>(
        std::count_if(sessions_.begin(), sessions_.end(),
                      [](const Session& session) { return session.state == State::open; }));
  }
  [[nodiscard]] const TransportCounters& counters() const noexcept { return counters_; }

 private:
  enum Control : std::uint8_t { rts = 16, cts = 17, end_of_message = 19, bam = 32, abort = 255 };
  /// `over`: it is counted; further packets of it may come, and mean nothing.
  enum class State : std::uint8_t { free, open, over };

  struct Session {
    State state = State::free;
    std::uint8_t source = 0;
    std::uint8_t destination = 0;
    std::uint8_t packets = 0;
    std::uint8_t received = 0;  ///< different ones
    std::uint16_t channel = 0;
    std::uint16_t size = 0;
    std::uint16_t next = 1;  ///< number that is expected; 256 after the last of 255
    std::uint16_t last = 0;  ///< number of the last packet that the receiver asked for
    std::uint32_t group = 0;
    base::Time deadline{};
    std::array<std::uint8_t, 32> present{};  ///< a bit a packet
    std::array<std::uint8_t, most_transported + bytes_a_packet> data{};

    [[nodiscard]] bool broadcast() const noexcept { return destination == global_address; }
    [[nodiscard]] bool is(std::uint8_t from, std::uint8_t to, std::uint16_t bus) const noexcept {
      return state != State::free && source == from && destination == to && channel == bus;
    }
    [[nodiscard]] bool has(unsigned place) const noexcept {
      return (present[place / 8] >> place % 8 & 1) != 0;
    }
    void toggle(unsigned place) noexcept {
      present[place / 8] = static_cast<std::uint8_t>(present[place / 8] ^ 1U << place % 8);
    }
  };

  Heard refuse() noexcept {
    ++counters_.malformed;
    return Heard::nothing;
  }
  [[nodiscard]] Session* find(std::uint8_t source, std::uint8_t destination, std::uint16_t channel) noexcept {
    for (Session& session : sessions_)
      if (session.is(source, destination, channel)) return &session;
    return nullptr;
  }
  /// Frees it; it is counted if it was not before.
  static void end(Session& session, std::uint32_t& cause) noexcept {
    if (session.state == State::open) ++cause;
    session.state = State::free;
  }
  /// Counts it, and keeps it so that its other packets are known.
  static void give_up(Session& session, std::uint32_t& cause) noexcept {
    if (session.state == State::open) ++cause;
    session.state = State::over;
  }

  Heard take_control(const Identifier& from, std::span<const std::uint8_t> data, base::Time now,
                     std::uint16_t channel) noexcept {
    const std::uint32_t number = data[5] | std::uint32_t{data[6]} << 8 | std::uint32_t{data[7]} << 16;
    if (number > 0x3'FFFF) return refuse();
    const std::uint32_t group = is_pdu1(number) ? number & 0x3'FF00 : number;
    switch (data[0]) {
      case bam:
      case rts:
        if ((data[0] == bam) != (from.destination == global_address)) return refuse();
        announce(from, data, group, now, channel);
        return Heard::control;
      case cts:
        if (Session* const session = find(from.destination, from.source, channel);
            session != nullptr && session->group == group)
          clear_to_send(*session, data, now);
        return Heard::control;
      case end_of_message:
        // Who answers has all of it: what is missing here went past this listener.
        if (Session* const session = find(from.destination, from.source, channel);
            session != nullptr && session->group == group)
          end(*session, counters_.lost_packet);
        return Heard::control;
      case abort: {
        Session* session = find(from.destination, from.source, channel);  // its receiver
        if (session == nullptr || session->group != group)
          session = find(from.source, from.destination, channel);  // or its sender
        if (session != nullptr && session->group == group) end(*session, counters_.aborted);
        return Heard::control;
      }
      default:
        return refuse();
    }
  }

  void announce(const Identifier& from, std::span<const std::uint8_t> data, std::uint32_t group,
                base::Time now, std::uint16_t channel) noexcept {
    Session* session = find(from.source, from.destination, channel);
    if (session != nullptr) end(*session, counters_.replaced);
    const auto size = static_cast<std::uint16_t>(data[1] | data[2] << 8);
    if (size < least_transported || size > most_transported || data[3] != packets_of(size)) {
      ++counters_.bad_size;
      return;
    }
    if (session == nullptr) session = unused();
    if (session == nullptr) {
      ++counters_.no_session;
      return;
    }
    ++counters_.announced;
    session->state = State::open;
    session->source = from.source;
    session->destination = from.destination;
    session->channel = channel;
    session->packets = data[3];
    session->received = 0;
    session->size = size;
    session->next = 1;
    session->last = session->broadcast() ? session->packets : 0;
    session->group = group;
    session->deadline = now + (session->broadcast() ? timeout::t1 : timeout::t3);
    session->present.fill(0);
  }
  /// A free one, or one that is only kept to know its late packets.
  [[nodiscard]] Session* unused() noexcept {
    for (const State state : {State::free, State::over})
      for (Session& session : sessions_)
        if (session.state == state) return &session;
    return nullptr;
  }

  void clear_to_send(Session& session, std::span<const std::uint8_t> data, base::Time now) noexcept {
    const unsigned count = data[1];
    const unsigned first = data[2];
    session.deadline = now + (count == 0 ? timeout::t4 : timeout::t2);
    if (count == 0) return;
    if (first == 0 || first > session.packets) return give_up(session, counters_.wrong_sequence);
    session.next = static_cast<std::uint16_t>(first);
    session.last = static_cast<std::uint16_t>(std::min<unsigned>(first + count - 1, session.packets));
    // What is asked for again has to come again.
    if (session.state == State::open)
      for (unsigned number = first; number <= session.last; ++number)
        if (session.has(number - 1)) session.toggle(number - 1), --session.received;
  }

  Heard take_packet(const Identifier& from, std::span<const std::uint8_t> data, base::Time now,
                    std::uint16_t channel) noexcept {
    Session* const session = find(from.source, from.destination, channel);
    if (session == nullptr) {
      ++counters_.stray;
      return Heard::packet;
    }
    const unsigned number = data[0];
    session->deadline = now + (number == session->last ? timeout::t3 : timeout::t1);
    if (session->state == State::over) {
      if (session->broadcast() && number == session->packets) session->state = State::free;
      return Heard::packet;
    }
    if (number == 0 || number > session->packets || number < session->next) {
      give_up(*session, counters_.wrong_sequence);
      return Heard::packet;
    }
    // Of a broadcast it cannot be requested again.
    if (session->broadcast() && number != session->next) {
      give_up(*session, counters_.lost_packet);
      if (number == session->packets) session->state = State::free;
      return Heard::packet;
    }
    const unsigned place = number - 1;
    std::copy_n(data.begin() + 1, bytes_a_packet,
                session->data.begin() + static_cast<std::ptrdiff_t>(place * bytes_a_packet));
    if (!session->has(place)) session->toggle(place), ++session->received;
    session->next = static_cast<std::uint16_t>(number + 1);
    if (session->received != session->packets) return Heard::packet;
    ++counters_.complete;
    message_ = {{from.priority, session->group, from.destination, from.source},
                std::span{session->data}.first(session->size)};
    session->state = session->broadcast() ? State::free : State::over;
    return Heard::message;
  }

  std::array<Session, Sessions> sessions_{};
  TransportCounters counters_;
  Transported message_;
};

}  // namespace ocm::j1939
