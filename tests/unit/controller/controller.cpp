#include "ocm/controller/controller.hpp"

#include <catch2/catch.hpp>

#include "unit/controller/fixture.hpp"

namespace controller_controller_test {

using namespace fixture;

TEST_CASE("a bad request is refused, counted by cause, and changes nothing") {
  struct Row {
    const char* text;
    std::uint32_t protocol::Counters::*counter;
    const char* answer;  // topic, reason, one so far
  };
  const Row rows[] = {
      {"208#03", &protocol::Counters::bad_mode, "71D#0804010000000000"},
      {"208#FF", &protocol::Counters::bad_mode, "71D#0804010000000000"},
      {"208#", &protocol::Counters::bad_length, "71D#0803010000000000"},
      {"208#0000", &protocol::Counters::bad_length, "71D#0803010000000000"},
      {"208#01F401", &protocol::Counters::bad_length, "71D#0803010000000000"},
      {"208#01F4010000", &protocol::Counters::bad_length, "71D#0803010000000000"},
      {"208#01F40103", &protocol::Counters::bad_unit, "71D#0805010000000000"},
      {"208#01000000", &protocol::Counters::bad_period, "71D#0806010000000000"},
      {"201#00", &protocol::Counters::bad_length, "71D#0103010000000000"},
      {"209#02", &protocol::Counters::not_served, "71D#0908010000000000"}};  // not served here
  for (const auto& row : rows) {
    CAPTURE(row.text);
    Board board;
    board.receive("208#01F40100", 0s);
    const auto next = board.controller.next_event();
    board.receive(row.text, 100ms);
    CHECK(board.controller.counters().*row.counter == 1);
    CHECK(board.controller.counters().refused() == 1);
    CHECK(board.controller.next_event() == next);
    REQUIRE(board.bus.frames.size() == 2);
    CHECK(texts(board.bus)[1] == row.answer);
  }
}

TEST_CASE("every frame is counted once, by what became of it") {
  Board board;
  for (const char* text :
       {"208#01F40100", "201#50C3000000000000", "201#00", "208#03", "21E#02", "204#02", "208#02"})
    board.receive(text, 0s);
  protocol::Counters expected;
  expected.received = 7;
  expected.foreign = 1;
  expected.requests = 3;
  expected.set_points = 1;
  expected.bad_length = 1;
  expected.bad_mode = 1;
  expected.samples = 4;  // two of the gyroscope, and the two refusals
  expected.sent = 4;
  expected.not_sampled = 1;
  CHECK(board.controller.counters() == expected);
  CHECK(board.bus.frames.size() == 4);
  board.bus.broken = true;
  board.receive("208#02", 1ms);
  expected.received = 8;
  expected.requests = 4;
  expected.samples = 5;
  expected.send_failed = 1;
  CHECK(board.controller.counters() == expected);
  board.controller.bus_lost();
  expected.bus_lost = 1;
  CHECK(board.controller.counters() == expected);
  CHECK(protocol::Counters{} == Board{}.controller.counters());
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

TEST_CASE("a task commands another board: the newest when the bus has room, and a broken bus is counted") {
  struct Commander {
    Mailboxes bus;
    controller::Controller<amiro::PowerManagement, Mailboxes, scheduling::Cooperative, 1> controller{bus};
    int steps = 0;
    int resumed = 0;
  } board;
  board.controller.every<0>(10ms, scheduling::Level::high, [&board](const scheduling::Release& release) {
    board.resumed += release.resumed ? 1 : 0;
    amiro::Motors motors;
    motors.x = ++board.steps;
    return board.controller.command(motors, protocol::Priority::high);
  });
  auto& [bus, controller, steps, resumed] = board;
  controller.poll(at(0ms));
  CHECK(texts(bus) == std::vector<std::string>{"101#0100000000000000"});
  CHECK(controller.counters().sent == 1);

  bus.room = 0;
  controller.poll(at(10ms));
  CHECK(steps == 2);
  CHECK(controller.waiting());
  controller.poll(at(25ms));  // no release while one waits, and still no room
  CHECK(bus.frames.size() == 1);
  bus.room = 1;
  controller.poll(at(26ms));
  CHECK(resumed >= 1);
  REQUIRE(bus.frames.size() == 2);
  CHECK(bus.frames[1].data[0] == steps);  // worked out just now
  CHECK_FALSE(controller.waiting());

  bus.broken = true;
  controller.poll(at(30ms));
  CHECK(controller.counters().send_failed == 1);
  CHECK_FALSE(controller.waiting());
  CHECK(controller.counters().sent == 2);
}

}  // namespace controller_controller_test
