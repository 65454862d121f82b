#include "ocm/j1939/transport.hpp"

#include <algorithm>
#include <map>
#include <random>
#include <vector>

#include <catch2/catch.hpp>

namespace j1939_transport_test {

using namespace ocm::j1939;
using namespace std::chrono_literals;
using ocm::base::Duration;
using ocm::base::Time;
using Bytes = std::vector<std::uint8_t>;
using Frame = std::array<std::uint8_t, 8>;

constexpr std::uint32_t bam_id = 0x1CEC'FF00;  // TP.CM from 00 to all
constexpr std::uint32_t data_id = 0x1CEB'FF00;
constexpr Time begin{1s};

static_assert(is_transport(bam_id) && is_transport(data_id));
static_assert(is_transport(0x00EC'1234) && is_transport(0x1CEB'3412));
static_assert(!is_transport(0x1DEC'FF00), "the data page is a part of the group");
static_assert(!is_transport(0x18EA'FF00) && !is_transport(0x18FE'EC00));
static_assert(least_transported > 8 && most_transported == 255 * bytes_a_packet);

template <std::size_t Sessions>
Bytes whole(const Transport<Sessions>& transport) {
  const auto data = transport.message().data;
  return {data.begin(), data.end()};
}
template <std::size_t Sessions>
std::uint32_t ended(const Transport<Sessions>& transport) {
  const TransportCounters& c = transport.counters();
  return c.complete + c.lost_packet + c.wrong_sequence + c.aborted + c.timed_out + c.replaced +
         static_cast<std::uint32_t>(transport.open());
}

Frame announcement(std::uint8_t control, std::size_t size, std::uint32_t group, std::uint8_t most = 0xFF) {
  return {control,
          static_cast<std::uint8_t>(size),
          static_cast<std::uint8_t>(size >> 8),
          static_cast<std::uint8_t>((size + 6) / 7),
          most,
          static_cast<std::uint8_t>(group),
          static_cast<std::uint8_t>(group >> 8),
          static_cast<std::uint8_t>(group >> 16)};
}
Frame clear_to_send(std::uint8_t count, std::uint8_t first, std::uint32_t group) {
  Frame frame = announcement(17, 0, group);
  frame[1] = count;
  frame[2] = first;
  frame[3] = 0xFF;
  return frame;
}
Frame abort_of(std::uint32_t group) {
  Frame frame = announcement(255, 0, group);
  frame[1] = 3;
  frame[2] = frame[3] = 0xFF;
  return frame;
}
Frame packet(const Bytes& message, std::size_t number) {
  Frame frame;
  frame.fill(0xFF);
  frame[0] = static_cast<std::uint8_t>(number);
  for (std::size_t i = 0; i < 7 && 7 * (number - 1) + i < message.size(); ++i)
    frame[i + 1] = message[7 * (number - 1) + i];
  return frame;
}
Bytes bytes(std::size_t size, unsigned seed = 0) {
  Bytes out(size);
  for (std::size_t i = 0; i < size; ++i) out[i] = static_cast<std::uint8_t>(i * 7 + seed);
  return out;
}
constexpr std::uint32_t id_of(std::uint32_t group, std::uint8_t from, std::uint8_t to) {
  return Identifier{7, group, to, from}.encode();
}

TEST_CASE("a broadcast is put together") {
  // Active diagnostic trouble codes (DM1, FECA): two of them in ten bytes. [SAE J1939-21, 5.10; J1939-73]
  Transport<1> transport;
  Time now = begin;
  CHECK(transport.take(bam_id, Frame{0x20, 0x0A, 0x00, 0x02, 0xFF, 0xCA, 0xFE, 0x00}, now) == Heard::control);
  CHECK(transport.open() == 1);
  CHECK(transport.take(data_id, Frame{0x01, 0x40, 0xFF, 0x64, 0x00, 0x03, 0x05, 0x6E}, now += 50ms) ==
        Heard::packet);
  CHECK(transport.take(data_id, Frame{0x02, 0x00, 0x04, 0x01, 0xFF, 0xFF, 0xFF, 0xFF}, now += 200ms) ==
        Heard::message);
  CHECK(transport.message().id == Identifier{7, 0xFECA, 255, 0});
  CHECK(whole(transport) == Bytes{0x40, 0xFF, 0x64, 0x00, 0x03, 0x05, 0x6E, 0x00, 0x04, 0x01});
  CHECK(transport.open() == 0);
  CHECK(transport.counters().complete == 1);
  CHECK(transport.counters().lost() == 0);
}

TEST_CASE("a connection is put together, in windows, with packets that are asked for again") {
  Transport<1> transport;
  const Bytes message = bytes(23);  // four packets
  const std::uint32_t group = 0xEF00;
  const std::uint32_t to = id_of(connection_group, 0x10, 0x20), back = id_of(connection_group, 0x20, 0x10);
  const std::uint32_t data = id_of(transfer_group, 0x10, 0x20);
  Time now = begin;
  CHECK(transport.take(to, announcement(16, 23, group, 2), now) == Heard::control);
  CHECK(transport.take(back, clear_to_send(0, 0xFF, group), now += 1200ms) == Heard::control);  // wait
  transport.take(back, clear_to_send(2, 1, group), now += 1000ms);
  transport.take(data, packet(message, 1), now += 1200ms);
  SECTION("all come") {
    transport.take(data, packet(message, 2), now += 700ms);
    transport.take(back, clear_to_send(2, 3, group), now += 1200ms);
    transport.take(data, packet(message, 3), now += 1ms);
    CHECK(transport.take(data, packet(message, 4), now += 1ms) == Heard::message);
  }
  SECTION("one is missing, and asked for") {
    transport.take(back, clear_to_send(2, 3, group), now += 700ms);
    transport.take(data, packet(message, 3), now += 1ms);
    CHECK(transport.take(data, packet(message, 4), now += 1ms) == Heard::packet);
    transport.take(back, clear_to_send(1, 2, group), now += 1ms);
    CHECK(transport.take(data, packet(message, 2), now += 1ms) == Heard::message);
  }
  SECTION("the others ask again for what came here") {
    transport.take(data, packet(message, 2), now += 1ms);
    transport.take(back, clear_to_send(4, 1, group), now += 1ms);
    for (std::size_t number = 1; number < 4; ++number)
      CHECK(transport.take(data, packet(message, number), now += 1ms) == Heard::packet);
    CHECK(transport.take(data, packet(message, 4), now += 1ms) == Heard::message);
    // The last again, since the other end did not hear it: it is known, and no message.
    transport.take(back, clear_to_send(1, 4, group), now += 1ms);
    CHECK(transport.take(data, packet(message, 4), now += 1ms) == Heard::packet);
  }
  CHECK(whole(transport) == message);
  CHECK(transport.message().id == Identifier{7, group, 0x20, 0x10});
  CHECK(transport.take(back, announcement(19, 23, group), now += 1ms) == Heard::control);
  CHECK(transport.counters().complete == 1);
  CHECK(transport.counters().lost() == 0);
  CHECK(transport.counters().stray == 0);
}

TEST_CASE("any packet of a window that came is asked for again, and comes again") {
  Transport<1> transport;
  const Bytes message = bytes(23);  // four packets
  const std::uint32_t data = id_of(transfer_group, 0x10, 0x20);
  transport.take(id_of(connection_group, 0x10, 0x20), announcement(16, 23, 0xEF00), begin);
  for (const std::size_t number : {1U, 2U}) transport.take(data, packet(message, number), begin);
  transport.take(id_of(connection_group, 0x20, 0x10), clear_to_send(3, 2, 0xEF00), begin);
  for (const std::size_t number : {2U, 3U})
    CHECK(transport.take(data, packet(message, number), begin) == Heard::packet);
  CHECK(transport.take(data, packet(message, 4), begin) == Heard::message);
  CHECK(whole(transport) == message);
}

TEST_CASE("the last packet of a window, asked for again although it came, is waited for") {
  Transport<1> transport;
  const Bytes message = bytes(20);  // three packets
  const std::uint32_t data = id_of(transfer_group, 0x10, 0x20);
  transport.take(id_of(connection_group, 0x10, 0x20), announcement(16, 20, 0xEF00), begin);
  for (const std::size_t number : {1U, 3U}) transport.take(data, packet(bytes(20, 9), number), begin);
  transport.take(id_of(connection_group, 0x20, 0x10), clear_to_send(3, 1, 0xEF00), begin);
  for (const std::size_t number : {1U, 2U})
    CHECK(transport.take(data, packet(message, number), begin) == Heard::packet);
  CHECK(transport.take(data, packet(message, 3), begin) == Heard::message);
  CHECK(whole(transport) == message);
}

// Each cause once in the sum; what was announced, complete, stray or malformed is no message that was lost.
static_assert(TransportCounters{128, 256, 1, 2, 4, 8, 16, 32, 64, 512, 1024}.lost() == 127);

TEST_CASE("sizes from 9 to 1785") {
  for (const std::size_t size : {9U, 13U, 14U, 15U, 64U, 65U, 1784U, 1785U}) {
    CAPTURE(size);
    Transport<1> transport;
    const Bytes message = bytes(size);
    transport.take(bam_id, announcement(32, size, 0xFECA), begin);
    const std::size_t packets = (size + 6) / 7;
    for (std::size_t number = 1; number < packets; ++number)
      REQUIRE(transport.take(data_id, packet(message, number), begin) == Heard::packet);
    CHECK(transport.take(data_id, packet(message, packets), begin) == Heard::message);
    CHECK(whole(transport) == message);
  }
  Transport<1> transport;
  for (const std::size_t size : {0U, 8U, 1786U, 65535U})
    transport.take(bam_id, announcement(32, size, 0xFECA), begin);
  Frame other = announcement(32, 20, 0xFECA);
  other[3] = 4;  // packets, where three do
  transport.take(bam_id, other, begin);
  CHECK(transport.counters().bad_size == 5);
  CHECK(transport.counters().announced == 0);
  CHECK(transport.open() == 0);
}

TEST_CASE("what is not whole is counted by its cause") {
  Transport<2> transport;
  const Bytes message = bytes(30);  // five packets
  const TransportCounters& counters = transport.counters();
  Time now = begin;
  const auto broadcast = [&](std::initializer_list<std::size_t> numbers) {
    transport.take(bam_id, announcement(32, 30, 0xFECA), now);
    for (const std::size_t number : numbers)
      CHECK(transport.take(data_id, packet(message, number), now += 50ms) == Heard::packet);
  };
  SECTION("a lost packet") {
    broadcast({1, 3, 4, 5});
    CHECK(counters.lost_packet == 1);
    broadcast({1, 2, 3, 5});
    CHECK(counters.lost_packet == 2);
    CHECK(counters.stray == 0);
    CHECK(transport.open() == 0);
  }
  SECTION("a packet twice, one with no number, one beyond the last") {
    broadcast({1, 2, 2, 3, 4, 5});
    broadcast({0, 1, 2, 3, 4, 5});
    broadcast({1, 6, 2, 3, 4, 5});
    CHECK(counters.wrong_sequence == 3);
    CHECK(counters.lost_packet == 0);
  }
  SECTION("a packet of a connection that came past, as its receiver says") {
    const std::uint32_t to = id_of(connection_group, 1, 2), back = id_of(connection_group, 2, 1);
    transport.take(to, announcement(16, 30, 0xFECA), now);
    for (const std::size_t number : {1U, 2U, 4U, 5U})
      transport.take(id_of(transfer_group, 1, 2), packet(message, number), now);
    CHECK(transport.open() == 1);
    transport.take(back, announcement(19, 30, 0xFECA), now);
    CHECK(counters.lost_packet == 1);
  }
  SECTION("a packet of a connection again that was not requested") {
    transport.take(id_of(connection_group, 1, 2), announcement(16, 30, 0xFECA), now);
    for (const std::size_t number : {1U, 2U, 1U, 2U, 3U, 4U, 5U})
      CHECK(transport.take(id_of(transfer_group, 1, 2), packet(message, number), now) == Heard::packet);
    CHECK(counters.wrong_sequence == 1);
  }
  SECTION("a receiver that asks for a packet that the message has not") {
    transport.take(id_of(connection_group, 1, 2), announcement(16, 30, 0xFECA), now);
    transport.take(id_of(connection_group, 2, 1), clear_to_send(1, 6, 0xFECA), now);
    CHECK(counters.wrong_sequence == 1);
  }
  SECTION("aborted by either end, and only by them, of this group") {
    const std::uint32_t to = id_of(connection_group, 1, 2), back = id_of(connection_group, 2, 1);
    transport.take(to, announcement(16, 30, 0xFECA), now);
    transport.take(back, abort_of(0xFECB), now);
    transport.take(id_of(connection_group, 2, 3), abort_of(0xFECA), now);
    CHECK(counters.aborted == 0);
    transport.take(back, abort_of(0xFECA), now);
    CHECK(counters.aborted == 1);
    transport.take(to, announcement(16, 30, 0xFECA), now);
    transport.take(to, abort_of(0xFECA), now);
    CHECK(counters.aborted == 2);
    CHECK(transport.open() == 0);
  }
  SECTION("replaced by the next") {
    broadcast({1, 2});
    broadcast({1, 2, 3, 4});
    CHECK(counters.replaced == 1);
    CHECK(transport.take(data_id, packet(message, 5), now) == Heard::message);
  }
  SECTION("packets of nothing that was announced") {
    transport.take(data_id, packet(message, 4), now);
    CHECK(counters.stray == 1);
    CHECK(counters.announced == 0);
  }
  SECTION("no session free") {
    for (std::uint8_t source = 0; source < 3; ++source)
      transport.take(id_of(connection_group, source, 255), announcement(32, 30, 0xFECA), now);
    CHECK(counters.announced == 2);
    CHECK(counters.no_session == 1);
    // One that is only kept for its late packets gives way.
    transport.take(id_of(transfer_group, 0, 255), packet(message, 2), now);
    transport.take(id_of(connection_group, 9, 255), announcement(32, 30, 0xFECA), now);
    CHECK(counters.announced == 3);
  }
  SECTION("no frame of the protocol") {
    const Frame frame = announcement(32, 30, 0xFECA);
    CHECK(transport.take(bam_id, std::span{frame}.first(7), now) == Heard::nothing);
    CHECK(transport.take(data_id, std::span{frame}.first(0), now) == Heard::nothing);
    CHECK(transport.take(bam_id, announcement(18, 30, 0xFECA), now) == Heard::nothing);
    CHECK(transport.take(bam_id, announcement(16, 30, 0xFECA), now) == Heard::nothing);  // RTS to all
    CHECK(transport.take(id_of(connection_group, 1, 2), announcement(32, 30, 0xFECA), now) == Heard::nothing);
    CHECK(transport.take(bam_id, announcement(32, 30, 0x4'0000), now) == Heard::nothing);
    CHECK(counters.malformed == 6);
    CHECK(transport.take(bam_id, announcement(32, 30, 0x3'FFFF), now) == Heard::control);  // the last group
    CHECK(transport.take(0x18FE'CA00, frame, now) == Heard::nothing);  // another group: not its business
    CHECK(counters.malformed == 6);
  }
  CHECK(counters.announced == ended(transport));
}

TEST_CASE("each step has its time, to the nanosecond") {
  const Bytes message = bytes(30);
  const std::uint32_t to = id_of(connection_group, 1, 2), back = id_of(connection_group, 2, 1);
  const std::uint32_t data = id_of(transfer_group, 1, 2);
  for (const auto late : {0ns, 1ns}) {
    CAPTURE(late.count());
    const std::uint32_t expected = late == 0ns ? 0 : 1;
    const auto after = [&](auto&& prepare, Duration limit) {
      Transport<1> transport;
      prepare(transport);
      transport.expire(begin + limit + late);
      CHECK(transport.counters().timed_out == expected);
      CHECK(transport.open() == 1 - expected);
      // Any other frame of the protocol tells it, too.
      Transport<1> other;
      prepare(other);
      other.take(id_of(transfer_group, 5, 6), packet(message, 1), begin + limit + late);
      CHECK(other.counters().timed_out == expected);
    };
    const auto rts = [&](auto& t) { t.take(to, announcement(16, 30, 0xFECA), begin); };
    after([&](auto& t) { t.take(bam_id, announcement(32, 30, 0xFECA), begin); }, 750ms);
    after(rts, 1250ms);
    const auto with = [&](const Frame& asked) {
      return [&, asked](auto& t) { rts(t), t.take(back, asked, begin); };
    };
    after(with(clear_to_send(0, 0xFF, 0xFECA)), 1050ms);
    after(with(clear_to_send(2, 1, 0xFECA)), 1250ms);
    after([&](auto& t) { with(clear_to_send(2, 1, 0xFECA))(t), t.take(data, packet(message, 1), begin); },
          750ms);
    after(
        [&](auto& t) {
          with(clear_to_send(2, 1, 0xFECA))(t);
          for (const std::size_t number : {1U, 2U}) t.take(data, packet(message, number), begin);
        },
        1250ms);  // the last that was asked for: the next CTS
  }
}

TEST_CASE("buses do not mix") {
  Transport<2> transport;
  const Bytes one = bytes(9, 1), two = bytes(9, 2);
  for (const std::uint16_t bus : {std::uint16_t{0}, std::uint16_t{1}})
    transport.take(bam_id, announcement(32, 9, 0xFECA), begin, bus);
  transport.take(data_id, packet(one, 1), begin, 0);
  transport.take(data_id, packet(two, 1), begin, 1);
  CHECK(transport.take(data_id, packet(two, 2), begin, 1) == Heard::message);
  CHECK(whole(transport) == two);
  CHECK(transport.take(data_id, packet(one, 2), begin, 0) == Heard::message);
  CHECK(whole(transport) == one);
}

/// What a source has still to send, one message after another; its receiver answers as the standard says.
struct Talker {
  std::uint8_t source, destination;
  Bytes message{};
  std::uint32_t group = 0;
  std::size_t next = 0;  // 0: the announcement
  [[nodiscard]] bool broadcast() const { return destination == 255; }
  [[nodiscard]] std::size_t packets() const { return (message.size() + 6) / 7; }
};

TEST_CASE("any mixture of messages comes out whole; of frames that are lost, nothing wrong does") {
  std::mt19937_64 random{21};
  const auto below = [&](std::size_t limit) { return static_cast<std::size_t>(random() % limit); };
  for (const bool lossy : {false, true}) {
    std::uint32_t sent = 0, heard = 0, lost_frames = 0;
    Transport<8> transport;
    std::vector<Talker> talkers{{1, 255}, {2, 255}, {1, 2}, {2, 1}, {3, 1}, {1, 3}, {4, 255}, {255 - 2, 4}};
    std::map<std::pair<std::uint8_t, std::uint8_t>, std::pair<std::uint32_t, Bytes>> latest;
    Time now = begin;
    const auto say = [&](std::uint32_t id, const Frame& frame) {
      now += Duration{static_cast<std::int64_t>(below(2'000'000))};
      if (lossy && below(100) == 0) {
        ++lost_frames;
        return;
      }
      if (transport.take(id, frame, now) != Heard::message) return;
      ++heard;
      const Identifier of = transport.message().id;
      const auto& [group, expected] = latest.at({of.source, of.destination});
      REQUIRE(of.pgn == group);
      REQUIRE(whole(transport) == expected);
    };
    for (int step = 0; step < 200'000; ++step) {
      Talker& talker = talkers[below(talkers.size())];
      const auto control = id_of(connection_group, talker.source, talker.destination);
      const auto back = id_of(connection_group, talker.destination, talker.source);
      if (talker.next == 0) {
        talker.message = bytes(9 + below(below(10) == 0 ? 1777 : 60));
        for (auto& byte : talker.message) byte = static_cast<std::uint8_t>(random());
        talker.group = 0xFE00 + static_cast<std::uint32_t>(below(256));
        latest[{talker.source, talker.destination}] = {talker.group, talker.message};
        ++sent;
        say(control, announcement(talker.broadcast() ? 32 : 16, talker.message.size(), talker.group));
        if (!talker.broadcast())
          say(back, clear_to_send(static_cast<std::uint8_t>(talker.packets()), 1, talker.group));
        talker.next = 1;
        continue;
      }
      say(id_of(transfer_group, talker.source, talker.destination), packet(talker.message, talker.next));
      if (talker.next++ < talker.packets()) continue;
      if (!talker.broadcast()) say(back, announcement(19, talker.message.size(), talker.group));
      talker.next = 0;
    }
    const auto under_way = static_cast<std::uint32_t>(
        std::count_if(talkers.begin(), talkers.end(), [](const Talker& talker) { return talker.next != 0; }));
    const TransportCounters& counters = transport.counters();
    CHECK(counters.complete == heard);
    CHECK(counters.announced == ended(transport));
    if (!lossy) {
      CHECK(heard == sent - under_way);
      CHECK(counters.lost() == 0);
      CHECK(counters.stray == 0);
      CHECK(transport.open() == under_way);
    } else {
      CHECK(lost_frames > 1000);
      CHECK(heard < sent);
      // A lost frame spoils one message at most.
      CHECK(heard + lost_frames + under_way >= sent);
      CHECK(counters.lost_packet + counters.wrong_sequence + counters.replaced > 0);
      CHECK(counters.no_session == 0);
    }
  }
}

}  // namespace j1939_transport_test
