#include "ocm/controller/actuator_handler.hpp"

#include <catch2/catch.hpp>

#include "unit/controller/fixture.hpp"

namespace controller_actuator_handler_test {

using namespace fixture;

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

TEST_CASE("motors that rest by a set point need no watchdog") {
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
  controller.poll(at(100ms) - 1ns);
  CHECK(calls == 1);
  controller.poll(at(100ms));
  CHECK(calls == 2);
}

TEST_CASE("a set point of the wrong length moves nothing") {
  Board board;
  for (const char* text : {"201#", "201#00", "201#50C30000000000"}) board.receive(text, 0s);
  CHECK(board.set_points.empty());
  CHECK(board.controller.counters().bad_length == 3);
  CHECK(board.controller.counters().set_points == 0);
  CHECK(board.controller.counters().foreign == 0);  // it is its own all the same
}

TEST_CASE("a set point that is too long lights nothing") {
  Mailboxes bus;
  controller::Controller<amiro::LightRing, Mailboxes> controller{bus};
  int calls = 0;
  controller.accept<amiro::Led>([&calls](std::uint8_t, const amiro::Led&) { ++calls; });
  controller.receive(frame("23C#64327800"), at(0s));
  controller.receive(frame("23C#6432780000000000"), at(0s));
  CHECK(calls == 0);
  CHECK(controller.counters().bad_length == 2);
  controller.receive(frame("23C#643278"), at(0s));
  CHECK(calls == 1);
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

TEST_CASE("a set point of the wrong length does not feed the watchdog") {
  Board board;
  board.receive("201#50C3000000000000", 0ms);
  board.receive("201#50C300", 400ms);
  CHECK(board.controller.next_event() == at(500ms));
}

TEST_CASE("each of several actuators has a timeout of its own") {
  Mailboxes bus;
  controller::Controller<amiro::LightRing, Mailboxes> controller{bus};
  std::vector<int> off;
  controller.accept<amiro::Led>(
      [&off](std::uint8_t number, const amiro::Led& led) {
        if (led == amiro::Led{}) off.push_back(number);
      },
      1s);
  controller.receive(frame("23C#FFFFFF"), at(0ms));
  controller.receive(frame("23D#FFFFFF"), at(300ms));
  CHECK(controller.next_event() == at(1000ms));
  controller.poll(at(1000ms));
  CHECK(off == std::vector<int>{1});
  CHECK(controller.next_event() == at(1300ms));
  controller.poll(at(1300ms));
  CHECK(off == std::vector<int>{1, 2});
}

TEST_CASE("motors come to rest at once when the bus is lost, and once") {
  Board board;
  board.controller.receive(protocol::command(amiro::Motors{50'000, 0}), at(0ms));
  board.controller.bus_lost();
  CHECK(board.set_points.size() == 1);  // the urgent level does it, as soon as it runs
  CHECK(board.controller.next_event() <= at(0ms));
  board.controller.poll(at(1ms));
  REQUIRE(board.set_points.size() == 2);
  CHECK(board.set_points[1] == amiro::Motors{});
  CHECK(board.controller.counters().bus_lost == 1);
  CHECK(board.controller.next_event() == base::never);
  board.controller.bus_lost();  // at rest already
  board.controller.poll(at(2s));
  CHECK(board.set_points.size() == 2);
  CHECK(board.controller.counters().bus_lost == 1);
  CHECK(board.controller.counters().timeouts == 0);
  board.controller.receive(protocol::command(amiro::Motors{20'000, 0}), at(3s));  // and it can go on
  CHECK(board.set_points.back() == amiro::Motors{20'000, 0});
  CHECK(board.controller.next_event() == at(3500ms));
}

TEST_CASE("what has no timeout stays as it is when the bus is lost") {
  Mailboxes bus;
  controller::Controller<amiro::LightRing, Mailboxes> controller{bus};
  int calls = 0;
  controller.accept<amiro::Led>([&calls](std::uint8_t, const amiro::Led&) { ++calls; });
  controller.receive(frame("23C#FFFFFF"), at(0s));
  controller.bus_lost();
  controller.poll(at(1s));
  CHECK(calls == 1);
  CHECK(controller.counters().bus_lost == 0);
}

TEST_CASE("a set point that comes while another is being applied is applied after it, by the same") {
  struct {
    Mailboxes bus;
    controller::Controller<amiro::DiWheelDrive, Mailboxes> controller{bus};
    std::vector<std::int32_t> applied;
    int depth = 0;
  } board;
  board.controller.accept<amiro::Motors>([&board](const amiro::Motors& motors) {
    CHECK(++board.depth == 1);
    board.applied.push_back(motors.x);
    if (motors.x == 1) {  // preempted: two more commands, the board loses the bus, and the urgent level runs
      board.controller.receive(protocol::command(amiro::Motors{2, 0}), at(1ms));
      board.controller.receive(protocol::command(amiro::Motors{3, 0}), at(1ms));
      board.controller.bus_lost();
      board.controller.poll(at(1ms));
      CHECK(board.applied.size() == 1);
    }
    --board.depth;
  });
  board.controller.receive(protocol::command(amiro::Motors{1, 0}), at(0ms));
  CHECK(board.applied == std::vector<std::int32_t>{1, 0});  // the last decision, and no older one after it
}

}  // namespace controller_actuator_handler_test
