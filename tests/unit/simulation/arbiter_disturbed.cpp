// The bus where the wire is disturbed: bit times by hand after ISO 11898-1, and random traffic with random
// disturbances against a bus that goes bit by bit (naive_bus.hpp).
#include <iostream>
#include <random>

#include <catch2/catch.hpp>

#include "ocm/simulation/arbiter.hpp"

#include "unit/base/explore.hpp"
#include "unit/simulation/arbiter_testing.hpp"
#include "unit/simulation/naive_bus.hpp"

namespace simulation_arbiter_disturbed_test {

using namespace ocm;
using namespace std::chrono_literals;
using simulation::Arbiter;
using simulation::Delivery;
using simulation::FaultConfinement;
using simulation::FaultState;
using simulation::Leftovers;
using simulation::NodeId;
using simulation::QueueOrder;
using test::frame;
using test::run;
using test::Texts;
using test::texts;

constexpr base::Duration bit = 2us;  // at 500 kbit/s

constexpr base::Time at(std::uint64_t boundary) {
  return base::Time{bit * static_cast<std::int64_t>(boundary)};
}

/// No five bits of it are equal, so there are no stuff bits: 44 + 5 * 8 = 84. [tests/unit/can/length.cpp]
constexpr can::Frame plain{.id = 0x555, .dlc = 5, .data = {0x55, 0x55, 0x55, 0x55, 0x55}};
constexpr std::uint64_t plain_bits = 84;
static_assert(can::frame_bits(plain) == plain_bits);

TEST_CASE(
    "a frame broken at its bit k: flags from k + 1, 8 bits delimiter, 3 intermission, the frame again") {
  for (const unsigned flags : {6U, 9U, 12U})
    for (std::uint64_t k = 0; k < plain_bits; ++k) {
      CAPTURE(flags, k);
      Arbiter bus;
      const NodeId node = bus.attach();
      CHECK(*bus.send(node, plain, at(100)));
      bus.disturb({100 + k, flags});
      const auto sent = run(bus);
      const bool last_bit = k == plain_bits - 1;  // receivers have it, the sender repeats it all the same
      REQUIRE(sent.size() == (last_bit ? 2 : 1));
      if (last_bit) {
        CHECK(sent[0].start == 100);
        CHECK(sent[0].end == 100 + plain_bits);
        CHECK_FALSE(sent[0].sent);
      }
      CHECK(sent.back().sent);
      CHECK(sent.back().start == 100 + k + 1 + flags + 8 + 3);
      CHECK(sent.back().end == sent.back().start + plain_bits);
      CHECK(bus.counters(node).broken == 1);
      CHECK(bus.counters(node).sent == 1);
      CHECK(bus.totals().frames == 1);
      CHECK(bus.totals().errors == 1);
      CHECK(bus.totals().repetitions == 1);
      CHECK(bus.totals().duplicates == (last_bit ? 1 : 0));
      CHECK(bus.totals().error_bits == k + 1 + flags + 8 + 3);
      CHECK(bus.totals().busy_bits == plain_bits + 3);
      CHECK(bus.faults(node).transmit_errors() == 7);  // 8 for the error, less 1 for the frame
    }
}

TEST_CASE("a disturbance is known when its bit is over, and is the next event") {
  Arbiter bus;
  const NodeId node = bus.attach({QueueOrder::fifo, 1});
  CHECK(*bus.send(node, plain, at(0)));
  bus.disturb({40});
  CHECK(bus.next_event() == at(41));
  CHECK(run(bus, at(41) - 1ns).empty());
  CHECK(bus.totals().errors == 0);
  CHECK(bus.waiting(node) == 0);
  CHECK(*bus.send(node, frame("001#")));  // there is room while a frame is on the bus
  CHECK(run(bus, at(41)).empty());
  CHECK(bus.totals().errors == 1);
  CHECK(bus.waiting(node) == 2);  // one more than it takes
  CHECK(bus.room(node) == 0);
  CHECK_FALSE(*bus.send(node, frame("002#")));
  CHECK(bus.next_event() == at(41 + 6 + 8 + 3 + plain_bits));
  CHECK(texts(run(bus)) == Texts{"555#5555555555", "001#"});
}

TEST_CASE("what was broken arbitrates again: with what came meanwhile, in its old place of its queue") {
  for (const QueueOrder order : {QueueOrder::fifo, QueueOrder::by_identifier}) {
    Arbiter bus;
    const NodeId a = bus.attach({order, 8});
    const NodeId b = bus.attach();
    for (const char* text : {"300#01", "400#02", "300#03"}) CHECK(*bus.send(a, frame(text), at(0)));
    bus.disturb({20});
    CHECK(run(bus, at(10)).empty());
    CHECK(*bus.send(b, frame("2FF#")));
    CHECK(*bus.send(a, frame("100#")));
    CHECK(run(bus, at(37)).empty());
    CHECK(*bus.send(b, frame("000#"), at(38)));  // at the very boundary where the next frame starts
    const Texts expected = order == QueueOrder::fifo
                               ? Texts{"2FF#", "000#", "300#01", "400#02", "300#03", "100#"}
                               : Texts{"100#", "2FF#", "000#", "300#01", "300#03", "400#02"};
    const auto sent = run(bus);
    CHECK(texts(sent) == expected);
    CHECK(sent[0].start == 20 + 1 + 6 + 8 + 3);
  }
}

TEST_CASE("on an idle bus a disturbance is a start of frame that no node continues") {
  // Dominant at 50, recessive at 51 to 56: a stuff error, flags from 57.
  Arbiter bus;
  const NodeId node = bus.attach();
  bus.disturb({50});
  CHECK(bus.next_event() == at(51));
  CHECK(run(bus, at(50)).empty());
  CHECK(bus.totals().errors == 0);
  CHECK(run(bus, at(51)).empty());
  CHECK(bus.totals().errors == 1);
  CHECK(*bus.send(node, plain, at(51)));
  CHECK(run(bus)[0].start == 57 + 6 + 8 + 3);
  CHECK(bus.totals().error_bits == 1 + 6 + 6 + 8 + 3);
  CHECK(bus.totals().repetitions == 0);
  CHECK(bus.faults(node).transmit_errors() == 0);
  CHECK(bus.faults(node).receive_errors() == 1);
}

TEST_CASE("a bus without nodes can be disturbed, too") {
  Arbiter bus;
  bus.disturb({50});
  CHECK(run(bus, at(51)).empty());
  CHECK(bus.totals().errors == 1);
  CHECK(bus.totals().error_bits == 1 + 6 + 6 + 8 + 3);
}

TEST_CASE("at the boundary at which a frame starts it is the frame that is disturbed") {
  Arbiter bus;
  const NodeId node = bus.attach();
  bus.disturb({50});
  CHECK(*bus.send(node, plain, at(50)));
  CHECK(run(bus)[0].start == 50 + 1 + 6 + 8 + 3);
  CHECK(bus.counters(node).broken == 1);
}

TEST_CASE("in the first two bits of the intermission: an overload frame, which counts as no error") {
  for (const std::uint64_t place : {0U, 1U}) {
    Arbiter bus;
    const NodeId node = bus.attach();
    CHECK(*bus.send(node, plain, at(0)));
    CHECK(*bus.send(node, plain, at(0)));
    bus.disturb({plain_bits + place, 7});
    const auto sent = run(bus);
    REQUIRE(sent.size() == 2);
    CHECK(sent[1].start == plain_bits + place + 1 + 7 + 8 + 3);
    CHECK(bus.totals().overloads == 1);
    CHECK(bus.totals().errors == 0);
    CHECK(bus.totals().busy_bits + bus.totals().error_bits == sent[1].end + 3);
    CHECK(bus.faults(node).clean());
  }
}

TEST_CASE("in the third bit of the intermission: the start of the frame that waits, a bit early") {
  Arbiter bus;
  const NodeId node = bus.attach();
  CHECK(*bus.send(node, plain, at(0)));
  CHECK(*bus.send(node, plain, at(plain_bits + 2)));
  bus.disturb({plain_bits + 2});
  const auto sent = run(bus);
  CHECK(sent[1].start == sent[0].end + 2);
  CHECK(bus.totals().errors == 0);
  CHECK(bus.totals().busy_bits == sent[1].end + 3);

  // What comes a bit later finds the bus taken.
  Arbiter late;
  const NodeId other = late.attach();
  CHECK(*late.send(other, plain, at(0)));
  CHECK(*late.send(other, plain, at(plain_bits + 3)));
  late.disturb({plain_bits + 2});
  CHECK(run(late)[1].start == plain_bits + 2 + 1 + 6 + 6 + 8 + 3);
  CHECK(late.totals().errors == 1);
}

TEST_CASE("in an error frame: another one") {
  Arbiter bus;
  const NodeId node = bus.attach();
  CHECK(*bus.send(node, plain, at(0)));
  bus.disturb({10, 6});   // flags 11 to 16, delimiter 17 to 24, intermission 25 to 27
  bus.disturb({24, 6});   // flags 25 to 30, delimiter 31 to 38, intermission 39 to 41
  bus.disturb({38, 12});  // flags 39 to 50, delimiter 51 to 58, intermission 59 to 61
  bus.disturb({59, 6});   // overload: flags 60 to 65, delimiter 66 to 73, intermission 74 to 76
  bus.disturb({60, 6});   // in its first flag bit: ends no earlier, and a bit later
  CHECK(run(bus)[0].start == 78);
  CHECK(bus.totals().errors == 4);
  CHECK(bus.totals().overloads == 1);
  CHECK(bus.totals().repetitions == 1);
  CHECK(bus.totals().error_bits == 78);
  CHECK(bus.faults(node).transmit_errors() == 4 * 8 - 1);
}

TEST_CASE("every error frame is reported as its disturbed bit is over: whose frame it was, or no node's") {
  Arbiter bus;
  const NodeId node = bus.attach();
  CHECK(*bus.send(node, plain, at(0)));
  bus.disturb({10});               // the node's
  bus.disturb({11});               // in the error frame: no node's
  bus.disturb({29 + plain_bits});  // overload: not told
  bus.disturb({400});              // on an idle bus
  std::vector<simulation::BusError> errors;
  std::vector<std::size_t> delivered;
  bus.advance(
      base::never, [&](const Delivery&) { delivered.push_back(errors.size()); },
      [&](const simulation::BusError& error) {
        errors.push_back(error);
        CHECK(bus.now() == error.time);
      });
  REQUIRE(errors.size() == 3);
  CHECK(errors[0].sender == node);
  CHECK(errors[0].time == at(11));
  CHECK(errors[1].sender == NodeId{});
  CHECK(errors[1].time == at(12));
  CHECK(errors[2].sender == NodeId{});
  CHECK(errors[2].time == at(401));
  CHECK(delivered == std::vector<std::size_t>{2});
  CHECK(bus.totals().overloads == 1);
}

TEST_CASE("a disturbance of the past is one of the next bit") {
  Arbiter bus;
  const NodeId node = bus.attach();
  CHECK(*bus.send(node, plain, at(0)));
  CHECK(run(bus, at(30) - 1ns).empty());
  bus.disturb({3});
  CHECK(run(bus)[0].start == 30 + 1 + 6 + 8 + 3);
}

TEST_CASE("a node that leaves repeats what was disturbed, or does not, and frees its place after it") {
  for (const Leftovers leftovers : {Leftovers::send, Leftovers::withdraw}) {
    Arbiter bus;
    const NodeId node = bus.attach();
    CHECK(*bus.send(node, plain, at(0)));
    CHECK(run(bus, at(10)).empty());
    bus.disturb({20});
    CHECK(bus.detach(node, leftovers) == 0);
    CHECK_FALSE(bus.attach().index == node.index);
    const auto sent = run(bus);
    const bool repeats = leftovers == Leftovers::send;
    CHECK(sent.size() == (repeats ? 1 : 0));
    CHECK(bus.totals().withdrawn == (repeats ? 0 : 1));
    CHECK(bus.totals().repetitions == (repeats ? 1 : 0));
    CHECK(bus.attach().index == node.index);
  }
}

TEST_CASE("a node leaves while its frame is on the bus and others of it wait") {
  Arbiter bus;
  const NodeId a = bus.attach();
  const NodeId b = bus.attach();
  for (const char* text : {"100#", "101#"}) CHECK(*bus.send(a, frame(text), at(0)));
  CHECK(*bus.send(b, frame("102#"), at(0)));
  CHECK(run(bus, at(10)).empty());
  CHECK(bus.detach(a, Leftovers::withdraw) == 1);
  CHECK(bus.next_event() == at(can::frame_bits(frame("100#"))));
  CHECK(texts(run(bus)) == Texts{"100#", "102#"});
}

TEST_CASE("error passive: 8 bits more after a frame of its own, in which others go first") {
  Arbiter bus;
  const NodeId a = bus.attach();
  for (int i = 0; i < 3; ++i) CHECK(*bus.send(a, plain, at(0)));
  // Broken at its first bit 17 times, each 18 bits apart until it is passive, then 26: 136, and 135 once
  // sent.
  for (std::uint64_t i = 0; i < 16; ++i) bus.disturb({18 * i});
  CHECK(run(bus, at(18 * 16)).empty());
  CHECK(bus.faults(a).transmit_errors() == 128);
  CHECK(bus.faults(a).state() == FaultState::error_passive);
  bus.disturb({18 * 16 + 8});
  std::uint64_t next = 18 * 16 + 26 + 8;
  CHECK(run(bus, at(next)).empty());
  CHECK(bus.totals().errors == 17);
  const auto first = run(bus, at(next + plain_bits));
  REQUIRE(first.size() == 1);
  CHECK(first[0].start == next);
  next = first[0].end + 3 + 8;
  CHECK(bus.next_event() == at(next + plain_bits));

  const NodeId b = bus.attach();
  CHECK(*bus.send(b, frame("7FF#"), at(next - 1)));
  const auto sent = run(bus);
  REQUIRE(sent.size() == 3);
  CHECK(sent[0].frame.id == 0x7FF);  // however urgent the others are
  CHECK(sent[0].start == next - 1);
  CHECK(sent[1].start == sent[0].end + 3);  // it was not the last to send
  CHECK(sent[2].start == sent[1].end + 3 + 8);
}

TEST_CASE("a node whose frames are always broken is off the bus after 32 times, and comes back") {
  Arbiter bus;
  const NodeId a = bus.attach();
  const NodeId b = bus.attach();
  CHECK(*bus.send(a, frame("100#"), at(0)));
  std::uint64_t next = 0;
  for (unsigned i = 0; i < 32; ++i) {
    bus.disturb({next});
    next += i + 1 < 16 ? 18 : 26;  // passive after the 16th
  }
  next -= 8;  // nothing is suspended after the 32nd
  CHECK(run(bus, at(next)).empty());
  CHECK(bus.faults(a).state() == FaultState::bus_off);
  CHECK(bus.faults(b).receive_errors() == 32);
  CHECK(bus.totals().errors == 32);
  CHECK(bus.waiting(a) == 1);
  CHECK(*bus.send(b, plain, at(next)));  // another has the bus for itself
  CHECK(run(bus, at(next + 40)).empty());
  CHECK(bus.faults(a).sequences_left() == 127);  // of a frame only the end counts
  CHECK(run(bus, at(next + plain_bits)).size() == 1);
  CHECK(bus.faults(a).sequences_left() == 127);  // one was the end of the error frame

  // Another is the end of that frame; then 126 of silence.
  const std::uint64_t back = next + plain_bits + 3 + 126 * 11;
  CHECK(run(bus, at(back) - 1ns).empty());
  CHECK(bus.faults(a).sequences_left() == 1);
  CHECK(bus.next_event() == at(back + can::frame_bits(frame("100#"))));
  CHECK(run(bus, at(back)).empty());
  CHECK(bus.faults(a).clean());
  const auto sent = run(bus);
  REQUIRE(sent.size() == 1);
  CHECK(sent[0].start == back);
  CHECK(sent[0].from == a);
}

// --- against a bus that goes bit by bit ---

using Random = std::mt19937;

struct Trace {
  struct Send {
    base::Time time{};
    std::size_t node = 0;
    can::Frame frame{};
  };
  std::vector<QueueOrder> orders;
  std::vector<Send> sends;  ///< in order of time
  std::vector<simulation::Disturbance> disturbances;
  std::uint64_t bits = 0;  ///< until all is silent
};

Trace random_trace(Random& random) {
  Trace trace;
  const std::size_t nodes = 1 + random() % 4;
  for (std::size_t n = 0; n < nodes; ++n)
    trace.orders.push_back(random() % 2 == 0 ? QueueOrder::fifo : QueueOrder::by_identifier);
  const std::uint64_t busy = 500 + random() % 5'000;
  const std::size_t frames = 1 + static_cast<std::size_t>(random() % (busy / 60));
  std::vector<std::uint64_t> boundaries(frames);
  for (auto& boundary : boundaries) boundary = random() % busy;
  std::sort(boundaries.begin(), boundaries.end());
  for (const std::uint64_t boundary : boundaries) {
    can::Frame frame;
    frame.id = random() % 4 == 0 ? random() % 8 : random() % 0x800;
    frame.dlc = static_cast<std::uint8_t>(random() % 9);
    for (std::size_t i = 0; i < frame.dlc; ++i) frame.data[i] = static_cast<std::uint8_t>(random());
    trace.sends.push_back({at(boundary), random() % nodes, frame});
  }
  // Some, many that come in bursts, or so many that nodes leave the bus.
  const std::size_t bursts = random() % 4 == 0 ? 60 + random() % 200 : random() % 12;
  const unsigned width = random() % 2 == 0 ? 1 : 40;
  for (std::size_t i = 0; i < bursts; ++i) {
    const std::uint64_t first = random() % (2 * busy);
    for (std::uint64_t k = random() % 3 + 1; k > 0; --k)
      trace.disturbances.push_back({first + random() % width, 6 + static_cast<unsigned>(random() % 7)});
  }
  trace.bits = 2 * busy + frames * 200 + 8 * (128 * 11 + 200) + 40 * trace.disturbances.size();
  return trace;
}

test::NaiveBus play_naively(const Trace& trace) {
  std::vector<test::NaiveNode> nodes(trace.orders.size());
  for (std::size_t n = 0; n < nodes.size(); ++n) nodes[n].fifo = trace.orders[n] == QueueOrder::fifo;
  for (const auto& send : trace.sends)
    nodes[send.node].queue.push_back(
        {send.frame, static_cast<std::uint64_t>(send.time.time_since_epoch() / bit)});
  test::NaiveBus bus{std::move(nodes)};
  for (const auto& disturbance : trace.disturbances) {
    unsigned& flags = bus.disturbances[disturbance.boundary];
    flags = std::max(flags, disturbance.flag_bits);
  }
  bus.run(trace.bits);
  return bus;
}

struct Played {
  std::vector<test::NaiveDelivery> deliveries;
  std::vector<FaultConfinement> faults;
  simulation::BusTotals totals;
};

/// Time is handed in at each hand-over and, if there is a generator, at any time in between.
Played play(const Trace& trace, Random* random) {
  Arbiter bus;
  std::vector<NodeId> nodes;
  for (const QueueOrder order : trace.orders) nodes.push_back(bus.attach({order, trace.sends.size()}));
  Played played;
  const auto advance = [&](base::Time time) {
    bus.advance(time, [&](const Delivery& d) {
      played.deliveries.push_back({d.frame, d.from.index, d.start, d.end, d.sent});
    });
  };
  for (const auto& disturbance : trace.disturbances) bus.disturb(disturbance);
  for (const auto& send : trace.sends) {
    while (random != nullptr && bus.now() < send.time && (*random)() % 4 != 0)
      advance(
          std::min(send.time, bus.now() + base::Duration{static_cast<std::int64_t>((*random)() % 100'000)}));
    advance(send.time);
    REQUIRE(*bus.send(nodes[send.node], send.frame));
  }
  // A caller that sleeps until the next event comes to an end.
  if (random != nullptr)
    for (base::Time next = bus.next_event(); next <= at(trace.bits); next = bus.next_event()) {
      advance(next);
      REQUIRE(bus.next_event() > next);
    }
  advance(at(trace.bits));
  for (const NodeId node : nodes) played.faults.push_back(bus.faults(node));
  played.totals = bus.totals();
  return played;
}

TEST_CASE("random disturbances: the same as bit by bit, and no frame is lost or sent twice") {
  Random random{11898};
  std::uint64_t broken = 0, overloads = 0, duplicates = 0, early = 0, off = 0;
  const int rounds = test::explored(1'000, 250);
  for (int round = 0; round < rounds; ++round) {
    CAPTURE(round);
    const Trace trace = random_trace(random);
    const test::NaiveBus naive = play_naively(trace);
    const Played played = play(trace, nullptr);
    REQUIRE(played.deliveries == naive.deliveries);
    REQUIRE(play(trace, &random).deliveries == naive.deliveries);

    std::uint64_t sent = 0;
    for (std::size_t i = 0; i < played.deliveries.size(); ++i) {
      sent += played.deliveries[i].sent ? 1 : 0;
      early += i > 0 && played.deliveries[i].start == played.deliveries[i - 1].end + 2 ? 1 : 0;
    }
    REQUIRE(sent == trace.sends.size());
    REQUIRE(played.totals.frames == sent);
    REQUIRE(played.totals.duplicates == played.deliveries.size() - sent);
    REQUIRE(played.totals.errors == naive.errors);
    REQUIRE(played.totals.overloads == naive.overloads);
    REQUIRE(played.totals.busy_bits + played.totals.error_bits == naive.bits_in_use);
    for (std::size_t n = 0; n < played.faults.size(); ++n) {
      REQUIRE(played.faults[n].transmit_errors() == naive.nodes()[n].transmit_errors);
      REQUIRE(played.faults[n].receive_errors() == naive.nodes()[n].receive_errors);
      REQUIRE(naive.nodes()[n].off == 0);
    }
    broken += played.totals.repetitions;
    overloads += played.totals.overloads;
    duplicates += played.totals.duplicates;
    off += naive.times_off;
  }
  std::cout << "  broken frames " << broken << ", overloads " << overloads << ", duplicates " << duplicates
            << ", early starts " << early << ", bus-off " << off << '\n';
  CHECK(broken > 0);
  CHECK(overloads > 0);
  CHECK(duplicates > 0);
  CHECK(early > 0);
  CHECK(off > 0);
}

}  // namespace simulation_arbiter_disturbed_test
