#include "ocm/simulation/arbiter.hpp"

#include <fstream>
#include <sstream>
#include <string>

#include <catch2/catch.hpp>

#include "ocm/can/bus.hpp"

#include "unit/simulation/arbiter_testing.hpp"

namespace simulation_arbiter_test {

using namespace ocm;
using namespace std::chrono_literals;
using simulation::Arbiter;
using simulation::Delivery;
using simulation::Leftovers;
using simulation::NodeId;
using simulation::QueueOrder;
using test::frame;
using test::run;
using test::Texts;
using test::texts;

constexpr base::Time at(base::Duration time) {
  return base::Time{time};
}

/// A trace of tests/sim/arbitration/schedule.txt.
struct Trace {
  struct Send {
    base::Time time;
    std::size_t sender;
    can::Frame frame;
  };
  struct Sent {
    std::size_t sender;
    can::Frame frame;
    std::uint64_t start, end;
    friend bool operator==(const Sent&, const Sent&) = default;
  };
  std::uint32_t bit_rate = 0;
  std::vector<QueueOrder> orders;
  std::vector<Send> sends;
  std::vector<Sent> schedule;
};

can::Frame read_frame(std::istream& line) {
  std::string format;
  std::string data;
  unsigned dlc = 0;
  can::Frame result;
  line >> format >> std::hex >> result.id >> std::dec >> dlc >> data;
  result.dlc = static_cast<std::uint8_t>(dlc);
  result.format = format == "base"          ? can::Format::base
                  : format == "base_remote" ? can::Format::base_remote
                  : format == "extended"    ? can::Format::extended
                                            : can::Format::extended_remote;
  for (std::size_t i = 0; data != "-" && i < data.size() / 2; ++i)
    result.data.at(i) = static_cast<std::uint8_t>(std::stoul(data.substr(2 * i, 2), nullptr, 16));
  return result;
}

std::vector<Trace> read_traces() {
  std::ifstream file{std::string{OCM_SOURCE_DIR} + "/tests/sim/arbitration/schedule.txt"};
  REQUIRE(file);
  std::vector<Trace> traces;
  for (std::string text; std::getline(file, text);) {
    std::istringstream line{text};
    std::string word;
    line >> word;
    if (word == "trace") {
      traces.emplace_back();
      line >> traces.back().bit_rate;
      while (line >> word)
        traces.back().orders.push_back(word == "fifo" ? QueueOrder::fifo : QueueOrder::by_identifier);
    } else if (word == "send") {
      std::int64_t time_ns = 0;
      Trace::Send send;
      line >> time_ns >> send.sender;
      send.time = at(base::Duration{time_ns});
      send.frame = read_frame(line);
      REQUIRE(line);
      traces.back().sends.push_back(send);
    } else if (word == "bus") {
      Trace::Sent sent;
      line >> sent.sender;
      sent.frame = read_frame(line);
      line >> sent.start >> sent.end;
      REQUIRE(line);
      traces.back().schedule.push_back(sent);
    }
  }
  return traces;
}

/// What the arbiter makes of a trace when time is handed in at each hand-over and, for `step` above zero,
/// that often in between.
std::vector<Trace::Sent> play(const Trace& trace, base::Duration step, bool advance_at_sends = true) {
  Arbiter bus{trace.bit_rate};
  std::vector<NodeId> nodes;
  for (const QueueOrder order : trace.orders) nodes.push_back(bus.attach({order, 2000}));
  std::vector<Trace::Sent> result;
  const auto advance = [&](base::Time time) {
    bus.advance(time, [&](const Delivery& delivery) {
      const auto sender = std::find(nodes.begin(), nodes.end(), delivery.from) - nodes.begin();
      result.push_back({static_cast<std::size_t>(sender), delivery.frame, delivery.start, delivery.end});
      CHECK(delivery.time == bus.clock().time_of(delivery.end));
      CHECK(delivery.time == bus.now());
    });
  };
  for (const Trace::Send& send : trace.sends) {
    if (step > 0ns)
      for (base::Time time = bus.now(); time < send.time; time += step) advance(time);
    if (advance_at_sends) advance(send.time);
    CHECK(*bus.send(nodes[send.sender], send.frame, send.time));
  }
  while (bus.next_event() != base::never) advance(bus.next_event());
  return result;
}

TEST_CASE("the bus makes of every trace what the independent computation makes of it, to the bit") {
  const auto traces = read_traces();
  REQUIRE(traces.size() == 2);
  REQUIRE(traces[0].sends.size() == 1000);
  for (const Trace& trace : traces) {
    REQUIRE(trace.orders.size() == 5);
    REQUIRE(trace.schedule.size() == trace.sends.size());
    const auto played = play(trace, 0ns);
    for (std::size_t i = 0; i < played.size(); ++i) {
      INFO("frame " << i << " of " << played.size() << " at " << trace.bit_rate << " bit/s");
      REQUIRE(played[i] == trace.schedule[i]);
    }
    // And it does not matter how often time is handed in.
    CHECK(play(trace, 7777ns) == trace.schedule);
    CHECK(play(trace, 0ns, false) == trace.schedule);
  }
}

TEST_CASE("two nodes send within one bit time: the lower identifier wins") {
  Arbiter bus;
  const NodeId a = bus.attach();
  const NodeId b = bus.attach();
  CHECK(*bus.send(a, frame("608#00"), at(10'001ns)));
  CHECK(*bus.send(b, frame("205#01"), at(11'999ns)));
  CHECK(texts(run(bus)) == Texts{"205#01", "608#00"});
}

TEST_CASE("a frame that comes a bit later waits, however urgent") {
  Arbiter bus;
  const NodeId a = bus.attach();
  const NodeId b = bus.attach();
  CHECK(*bus.send(a, frame("7FF#"), at(10us)));
  CHECK(*bus.send(b, frame("000#"), at(10'001ns)));
  const auto sent = run(bus);
  CHECK(texts(sent) == Texts{"7FF#", "000#"});
  CHECK(sent[0].start == 5);
  CHECK(sent[1].start == sent[0].end + 3);
}

TEST_CASE("a start of frame is decided only when time has passed it") {
  Arbiter bus;
  const NodeId a = bus.attach();
  const NodeId b = bus.attach();
  CHECK(*bus.send(a, frame("7FF#"), at(10us)));
  CHECK(run(bus, at(10us)).empty());  // the boundary itself still belongs to the arbitration
  CHECK(*bus.send(b, frame("000#"), at(10us)));
  CHECK(run(bus, at(10'001ns)).empty());
  CHECK(*bus.send(b, frame("001#"), at(10'001ns)));
  CHECK(texts(run(bus)) == Texts{"000#", "001#", "7FF#"});
}

TEST_CASE("of a socket only the head takes part, of mailboxes the lowest identifier") {
  for (const QueueOrder order : {QueueOrder::fifo, QueueOrder::by_identifier}) {
    Arbiter bus;
    const NodeId a = bus.attach({order, 3});
    const NodeId b = bus.attach({QueueOrder::fifo, 3});
    for (const char* text : {"700#01", "100#02", "100#03"}) CHECK(*bus.send(a, frame(text), at(0ns)));
    CHECK(*bus.send(b, frame("400#"), at(0ns)));
    const Texts expected = order == QueueOrder::fifo ? Texts{"400#", "700#01", "100#02", "100#03"}
                                                     : Texts{"100#02", "100#03", "400#", "700#01"};
    CHECK(texts(run(bus)) == expected);
  }
}

TEST_CASE("a full queue refuses, counts, and has room again when a frame has started") {
  Arbiter bus;
  const NodeId a = bus.attach({QueueOrder::fifo, 2});
  CHECK(*bus.send(a, frame("001#"), at(0ns)));
  CHECK(*bus.send(a, frame("002#"), at(0ns)));
  const auto refused = bus.send(a, frame("003#"), at(0ns));
  REQUIRE(refused.ok());
  CHECK_FALSE(*refused);
  CHECK(bus.counters(a).refused == 1);
  CHECK(bus.room(a) == 0);
  CHECK(run(bus, at(1us)).empty());  // on the bus now
  CHECK(bus.waiting(a) == 1);
  CHECK(*bus.send(a, frame("004#"), at(1us)));
  CHECK(texts(run(bus)) == Texts{"001#", "002#", "004#"});
  CHECK(bus.counters(a).sent == 3);
  CHECK(bus.totals().frames == 3);
  CHECK(bus.totals().refused == 1);
}

TEST_CASE("a node's queue takes 64 frames, unless more is said") {
  Arbiter bus;
  CHECK(bus.room(bus.attach()) == 64);
}

TEST_CASE("frames that cannot exist are errors") {
  Arbiter bus;
  const NodeId a = bus.attach();
  CHECK(bus.send(a, {.id = 0x800}, at(0ns)).error == base::Error::bad_identifier);
  CHECK(bus.send(a, {.id = 1, .dlc = 9}, at(0ns)).error == base::Error::bad_length);
  CHECK(bus.send(a, {.id = 4, .format = can::Format::error}, at(0ns)).error == base::Error::bad_identifier);
  CHECK(bus.send(NodeId{}, frame("001#"), at(0ns)).error == base::Error::closed);
  CHECK(bus.send(NodeId{1, 1}, frame("001#"), at(0ns)).error == base::Error::closed);
  CHECK(bus.send(NodeId{7, 1}, frame("001#"), at(0ns)).error == base::Error::closed);
  CHECK(bus.next_event() == base::never);
}

TEST_CASE("a saturated bus has load 1, an idle one stays where it was") {
  Arbiter bus;
  const NodeId a = bus.attach({QueueOrder::fifo, 1000});
  for (int i = 0; i < 1000; ++i) CHECK(*bus.send(a, frame("123#DEADBEEF"), at(0ns)));
  const auto sent = run(bus);
  CHECK(bus.totals().busy_bits == sent.back().end + can::intermission_bits);
  CHECK(run(bus, at(1h)).empty());
  CHECK(bus.totals().frames == 1000);
}

TEST_CASE("who answers a frame at once takes part in the next arbitration") {
  Arbiter bus;
  const NodeId board = bus.attach();
  const NodeId host = bus.attach();
  CHECK(*bus.send(host, frame("204#02"), at(0ns)));
  CHECK(*bus.send(host, frame("7FF#"), at(0ns)));
  std::vector<Delivery> sent;
  bus.advance(base::never, [&](const Delivery& delivery) {
    sent.push_back(delivery);
    if (delivery.frame.id == 0x204) CHECK(*bus.send(board, frame("604#")));
  });
  CHECK(texts(sent) == Texts{"204#02", "604#", "7FF#"});
  CHECK(sent[1].start == sent[0].end + can::intermission_bits);
  CHECK(sent[1].from == board);
}

TEST_CASE("a node that leaves takes its waiting frames along, or has them sent") {
  Arbiter bus;
  const NodeId a = bus.attach();
  const NodeId b = bus.attach();
  for (const NodeId node : {a, b})
    for (const char* text : {"100#", "101#", "102#"}) CHECK(*bus.send(node, frame(text), at(0ns)));
  CHECK(run(bus, at(1us)).empty());  // 100# of a is on the bus
  CHECK(bus.detach(a, Leftovers::withdraw) == 2);
  CHECK(bus.detach(a, Leftovers::withdraw) == 0);
  CHECK(bus.detach(b, Leftovers::send) == 0);
  CHECK(bus.send(a, frame("103#"), at(1us)).error == base::Error::closed);
  CHECK(bus.send(b, frame("103#"), at(1us)).error == base::Error::closed);
  const auto sent = run(bus);
  CHECK(texts(sent) == Texts{"100#", "100#", "101#", "102#"});
  CHECK(sent[0].from == a);
  CHECK(sent[3].from == b);
  CHECK(bus.attach().index == a.index);  // both places are free again
  CHECK(bus.attach().index == b.index);
  CHECK(bus.totals().withdrawn == 2);
  CHECK(bus.totals().clashes == 1);
}

TEST_CASE("a node that leaves has room for nothing, and once it has left nothing is known of it") {
  Arbiter bus;
  const NodeId a = bus.attach();
  for (const char* text : {"100#", "101#"}) CHECK(*bus.send(a, frame(text), at(0ns)));
  CHECK(run(bus, at(1us)).empty());  // 100# is on the bus
  bus.detach(a, Leftovers::send);
  CHECK(bus.waiting(a) == 1);
  CHECK(bus.room(a) == 0);
  CHECK(run(bus).size() == 2);
  CHECK(bus.waiting(a) == 0);
  CHECK(bus.room(a) == 0);
  CHECK(bus.counters(a).sent == 0);
  CHECK(bus.faults(a).clean());
  CHECK(bus.detach(a, Leftovers::withdraw) == 0);
}

TEST_CASE("a node without frames leaves at once") {
  Arbiter bus;
  const NodeId a = bus.attach();
  bus.detach(a, Leftovers::send);
  CHECK(bus.attach().index == a.index);
}

TEST_CASE("a frame that would be the next one is withdrawn with its node") {
  Arbiter bus;
  const NodeId a = bus.attach();
  CHECK(*bus.send(a, frame("100#"), at(1us)));
  CHECK(bus.next_event() != base::never);
  CHECK(bus.detach(a, Leftovers::withdraw) == 1);
  CHECK(bus.next_event() == base::never);
  CHECK(run(bus).empty());
}

TEST_CASE("a place on the bus is used again, its old number is not") {
  Arbiter bus;
  const NodeId first = bus.attach();
  CHECK(*bus.send(first, frame("001#"), at(0ns)));
  CHECK(run(bus, at(1us)).empty());
  bus.detach(first, Leftovers::send);
  CHECK_FALSE(bus.attach().index == first.index);  // its frame may have to be repeated
  CHECK(bus.send(first, frame("002#"), at(1us)).error == base::Error::closed);
  CHECK(run(bus)[0].from == first);
  const NodeId second = bus.attach({QueueOrder::fifo, 1});
  CHECK(second.index == first.index);
  CHECK_FALSE(second == first);
  CHECK(bus.send(first, frame("002#"), at(1us)).error == base::Error::closed);
  CHECK(bus.counters(second).sent == 0);
  CHECK(bus.room(second) == 1);
}

TEST_CASE("two nodes with the same identifier: the lower index sends first, and it is counted") {
  Arbiter bus;
  const NodeId a = bus.attach();
  const NodeId b = bus.attach();
  CHECK(*bus.send(b, frame("100#02"), at(0ns)));
  CHECK(*bus.send(a, frame("100#01"), at(0ns)));
  CHECK(texts(run(bus)) == Texts{"100#01", "100#02"});
  CHECK(bus.totals().clashes == 1);
}

TEST_CASE("a clash behind a winner is none yet") {
  Arbiter bus;
  for (const char* text : {"200#", "200#", "100#"}) CHECK(*bus.send(bus.attach(), frame(text), at(0ns)));
  CHECK(run(bus, bus.next_event()).size() == 1);
  CHECK(bus.totals().clashes == 0);
  CHECK(run(bus).size() == 2);
  CHECK(bus.totals().clashes == 1);
}

TEST_CASE("next_event is the end of the next frame, and changes when a shorter one wins") {
  Arbiter bus;
  CHECK(bus.next_event() == base::never);
  const NodeId a = bus.attach();
  const NodeId b = bus.attach();
  CHECK(*bus.send(a, frame("400#0102030405060708"), at(1us)));
  const base::Time long_end = bus.next_event();
  CHECK(long_end == bus.clock().time_of(1 + can::frame_bits(frame("400#0102030405060708"))));
  CHECK(*bus.send(b, frame("100#"), at(1us)));
  CHECK(bus.next_event() == bus.clock().time_of(1 + can::frame_bits(frame("100#"))));
  CHECK(run(bus, bus.next_event() - 1ns).empty());
  CHECK(run(bus, bus.next_event()).size() == 1);
}

TEST_CASE("time that goes backwards is taken as the present") {
  Arbiter bus{500'000, at(1s)};
  const NodeId a = bus.attach();
  CHECK(*bus.send(a, frame("001#"), at(0ns)));
  CHECK(run(bus, at(2s))[0].start == 0);
  CHECK(*bus.send(a, frame("001#"), at(1s)));
  CHECK(run(bus, at(1500ms)).empty());
  CHECK(bus.now() == at(2s));
  CHECK(run(bus)[0].start == 500'000);
}

TEST_CASE("a port is what a board sends to") {
  STATIC_REQUIRE(can::Sender<simulation::Port>);
  Arbiter bus;
  simulation::Port port{bus, {QueueOrder::by_identifier, 1}};
  CHECK(*port.send(frame("605#")));
  CHECK_FALSE(*port.send(frame("606#")));
  CHECK(run(bus)[0].from == port.node());
}

}  // namespace simulation_arbiter_test
