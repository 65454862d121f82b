#include "ocm/controller/controller.hpp"

#include <vector>

#include <catch2/catch.hpp>

#include "ocm/can/text.hpp"
#include "ocm/protocol/message.hpp"
#include "ocm/topics/amiro.hpp"

using namespace ocm;
using namespace std::chrono_literals;

namespace {

/// A bus with room for `room` frames.
struct Mailboxes {
  base::Result<bool> send(const can::Frame& frame) {
    if (broken) return base::Error::closed;
    if (room == 0) return false;
    --room;
    frames.push_back(frame);
    return true;
  }
  std::size_t room = 1000;
  bool broken = false;
  std::vector<can::Frame> frames;
};

can::Frame frame(std::string_view text) {
  const auto parsed = can::parse_frame(text);
  REQUIRE(parsed.ok());
  return *parsed;
}

std::vector<std::string> texts(const Mailboxes& bus) {
  std::vector<std::string> result;
  for (const auto& sent : bus.frames) result.emplace_back(can::to_text(sent).view());
  return result;
}

base::Time at(base::Duration offset) {
  return base::Time{offset};
}

/// DiWheelDrive with everything served: each sample says how many there were.
struct Board {
  Mailboxes bus;
  controller::Controller<amiro::DiWheelDrive, Mailboxes> controller{bus};
  std::int16_t reads = 0;
  std::vector<amiro::Motors> set_points;

  Board() {
    controller.serve<amiro::Gyroscope>([this] {
      ++reads;
      return base::Result<amiro::Gyroscope>{amiro::Gyroscope{reads, 0, -1}};
    });
    controller.serve<amiro::Magnetometer>([] {
      return base::Result<amiro::Magnetometer>{amiro::Magnetometer{{53760}, {-939520}, {1523200}}};
    });
    controller.serve<amiro::FloorProximity>(
        [](base::Time) { return base::Result<amiro::FloorProximity>{base::Error::not_sampled}; });
    controller.accept<amiro::Motors>([this](const amiro::Motors& motors) { set_points.push_back(motors); });
  }
  void receive(std::string_view text, base::Duration now) {
    controller.receive(frame(text), at(now));
    controller.poll(at(now));
  }
};

}  // namespace

TEST_CASE("publish: the first sample at once, then on the grid") {
  Board board;
  board.receive("208#01F40100", 1s);  // every 500 ms
  CHECK(texts(board.bus) == std::vector<std::string>{"608#01000000FFFF"});
  CHECK(board.controller.next_event() == at(1500ms));
  board.controller.poll(at(1499ms));
  CHECK(board.bus.frames.size() == 1);
  board.controller.poll(at(1500ms));
  CHECK(board.bus.frames.size() == 2);
}

TEST_CASE("the priority of a request is the priority of its frames") {  // thesis 4.1
  Board board;
  board.receive("008#01F40100", 0s);
  board.receive("308#01F40100", 100ms);  // the next request changes it while running
  CHECK(texts(board.bus) == std::vector<std::string>{"408#01000000FFFF", "708#02000000FFFF"});
}

TEST_CASE("DLC 1 publishes at the topic's own period") {
  Board board;
  board.receive("205#01", 0s);
  REQUIRE(board.bus.frames.size() == 3);
  CHECK(board.controller.next_event() == at(amiro::Magnetometer::period.duration()));
}

TEST_CASE("the three magnetometer frames go out back to back") {  // thesis figure 7.2: 59 to 120 ms apart
  Board board;
  board.receive("205#01840302", 0s);
  CHECK(texts(board.bus) == std::vector<std::string>{"605#00D20000", "606#00AAF1FF", "607#003E1700"});
}

TEST_CASE("once sends one sample, and stops a publisher") {  // thesis figure 5.2
  Board board;
  board.receive("208#01F40100", 0s);
  board.receive("208#02", 100ms);
  CHECK(board.bus.frames.size() == 2);
  CHECK(board.controller.next_event() == base::never);
}

TEST_CASE("stop suspends") {
  Board board;
  board.receive("208#01F40100", 0s);
  board.receive("208#00", 100ms);
  board.controller.poll(at(10s));
  CHECK(board.bus.frames.size() == 1);
}

TEST_CASE("a bad request is refused, counted by cause, and changes nothing") {
  struct Row {
    const char* text;
    std::uint32_t protocol::Counters::*counter;
  };
  const Row rows[] = {
      {"208#03", &protocol::Counters::bad_mode},       {"208#FF", &protocol::Counters::bad_mode},
      {"208#", &protocol::Counters::bad_length},       {"208#0000", &protocol::Counters::bad_length},
      {"208#01F401", &protocol::Counters::bad_length}, {"208#01F4010000", &protocol::Counters::bad_length},
      {"208#01F40103", &protocol::Counters::bad_unit}, {"208#01000000", &protocol::Counters::bad_period},
      {"209#02", &protocol::Counters::not_served}};  // nothing serves the accelerometer here
  for (const auto& row : rows) {
    CAPTURE(row.text);
    Board board;
    board.receive("208#01F40100", 0s);
    const auto next = board.controller.next_event();
    board.receive(row.text, 100ms);
    CHECK(board.controller.counters().*row.counter == 1);
    CHECK(board.controller.counters().refused() == 1);
    CHECK(board.controller.next_event() == next);
    CHECK(board.bus.frames.size() == 1);
  }
}

TEST_CASE("a board is silent on what is not its own") {
  Board board;
  for (const char* text :
       {"21E#02", "21F#02", "23C#FF0000", "608#000000000000", "208#R", "00000208#02", "206#02"})
    board.receive(text, 0s);
  CHECK(board.bus.frames.empty());
  CHECK(board.controller.counters().foreign == 7);
  CHECK(board.controller.counters().received == 7);
  CHECK(board.controller.counters().refused() == 0);
}

TEST_CASE("a part that does not answer costs its own samples only") {
  Board board;
  board.receive("204#01F40100", 0s);
  board.receive("208#01F40100", 0s);
  CHECK(board.controller.counters().not_sampled == 1);
  CHECK(board.bus.frames.size() == 1);
}

TEST_CASE("a sample waits for the bus and is never mixed with the next one") {
  Board board;
  board.bus.room = 2;
  board.receive("205#010A0000", 0s);  // every 10 ms, three frames
  CHECK(board.bus.frames.size() == 2);
  CHECK(board.controller.waiting());
  board.controller.poll(at(10ms));  // still no room: this release is given up
  CHECK(board.controller.counters().overrun == 1);
  board.bus.room = 10;
  board.controller.poll(at(11ms));
  CHECK(texts(board.bus) == std::vector<std::string>{"605#00D20000", "606#00AAF1FF", "607#003E1700"});
  CHECK_FALSE(board.controller.waiting());
}

TEST_CASE("an urgent sample overtakes one that waits") {
  Board board;
  board.bus.room = 1;
  board.receive("305#02", 0s);  // low: one of three frames leaves
  board.receive("008#02", 0s);  // urgent
  board.bus.room = 1;
  board.controller.poll(at(1ms));
  REQUIRE(board.bus.frames.size() == 2);
  CHECK(board.bus.frames[1].id == 0x408);
}

TEST_CASE("a bus that fails is counted, and the sample given up") {
  Board board;
  board.bus.broken = true;
  board.receive("205#02", 0s);
  CHECK(board.controller.counters().send_failed == 1);
  CHECK_FALSE(board.controller.waiting());
}

TEST_CASE("motors stop 500 ms after the last command") {
  Board board;
  const auto command = protocol::command(amiro::Motors{50'000, 0});
  board.controller.receive(command, at(0ms));
  board.controller.receive(command, at(400ms));
  board.controller.poll(at(899ms));
  REQUIRE(board.set_points.size() == 2);
  CHECK(board.controller.next_event() == at(900ms));
  board.controller.poll(at(900ms));
  REQUIRE(board.set_points.size() == 3);
  CHECK(board.set_points[2] == amiro::Motors{});
  CHECK(board.controller.counters().timeouts == 1);
  board.controller.poll(at(5s));
  CHECK(board.set_points.size() == 3);
}

TEST_CASE("motors that were told to rest need no watchdog") {
  Board board;
  board.controller.receive(protocol::command(amiro::Motors{50'000, 0}), at(0ms));
  board.controller.receive(protocol::command(amiro::Motors{}), at(100ms));
  CHECK(board.controller.next_event() == base::never);
  board.controller.poll(at(5s));
  CHECK(board.controller.counters().timeouts == 0);
}

TEST_CASE("the timeout can be chosen") {
  Mailboxes bus;
  controller::Controller<amiro::DiWheelDrive, Mailboxes> controller{bus};
  int calls = 0;
  controller.accept<amiro::Motors>([&calls](const amiro::Motors&) { ++calls; }, 100ms);
  controller.receive(protocol::command(amiro::Motors{1, 0}), at(0ms));
  controller.poll(at(100ms));
  CHECK(calls == 2);
}

TEST_CASE("a set point of the wrong length moves nothing") {
  Board board;
  for (const char* text : {"201#", "201#00", "201#50C30000000000"}) board.receive(text, 0s);
  CHECK(board.set_points.empty());
  CHECK(board.controller.counters().bad_length == 3);
}

TEST_CASE("each LED gets its own set point") {
  Mailboxes bus;
  controller::Controller<amiro::LightRing, Mailboxes> controller{bus};
  std::vector<std::pair<int, amiro::Led>> calls;
  controller.accept<amiro::Led>(
      [&calls](std::uint8_t number, const amiro::Led& led) { calls.emplace_back(number, led); });
  controller.receive(frame("23C#643278"), at(0s));
  controller.receive(frame("243#FFFFFF"), at(0s));
  controller.receive(frame("244#FFFFFF"), at(0s));  // one behind the last
  controller.receive(frame("23B#FFFFFF"), at(0s));  // one before the first
  REQUIRE(calls.size() == 2);
  CHECK(calls[0] == std::pair<int, amiro::Led>{1, amiro::Led{100, 50, 120}});  // the thesis's figure 6.1
  CHECK(calls[1].first == 8);
  CHECK(controller.counters().foreign == 2);
  CHECK(controller.next_event() == base::never);  // LEDs stay on
}
