#include "ocm/controller/report.hpp"

#include <cstddef>
#include <utility>

#include <catch2/catch.hpp>

#include "unit/controller/fixture.hpp"

namespace controller_report_test {

using namespace fixture;
using Status = amiro::DiWheelDriveStatus;

/// The status that the board sends when asked.
Status ask_status(Board& board, base::Duration now) {
  board.bus.frames.clear();
  board.receive("31B#02", now);
  REQUIRE(board.bus.frames.size() == 2);
  CHECK(board.bus.frames[0].id == 0x71B);
  CHECK(board.bus.frames[1].id == 0x71C);
  return Status::decode({board.bus.frames[0].data, board.bus.frames[1].data});
}

TEST_CASE("status: a board says how it is without being taught to") {
  Board board;
  const Status status = ask_status(board, 90'061s);
  CHECK(status.identity.uptime == 90'061);
  CHECK(status.identity.reset == amiro::DiWheelDriveStatusIdentity::Reset::unknown);
  CHECK(status.identity.wire_hash == amiro::wire_hash);
  CHECK(status.health.load == amiro::DiWheelDriveStatusHealth::load_unknown);
  CHECK(status.health.bus == amiro::DiWheelDriveStatusHealth::Bus::active);
  CHECK(status.health.publishing == 0);
  CHECK(status.health.faults == 0);
  CHECK(status.health.overload == 0);
  CHECK(status.health.bus_errors == 0);
}

TEST_CASE("status: what only the board knows") {
  Board board;
  board.controller.report([] { return controller::Health{4, 37, 2, 70'000}; });
  const Status status = ask_status(board, 1s);
  CHECK(status.identity.reset == amiro::DiWheelDriveStatusIdentity::Reset::watchdog);
  CHECK(status.health.load == 37);
  CHECK(status.health.bus == amiro::DiWheelDriveStatusHealth::Bus::passive);
  CHECK(status.health.bus_errors == 65'535);  // stays at its end
}

TEST_CASE("refusal: the board counts what a host on its serial line has lost") {
  Board board;
  std::uint32_t lost = 0x1234;
  board.controller.report([&lost] { return controller::Health{.line_lost = lost}; });
  board.receive("31D#02", 1s);
  CHECK(texts(board.bus) == std::vector<std::string>{"71D#0000000000003412"});
  board.bus.frames.clear();
  lost = 70'000;
  board.receive("31D#02", 2s);
  CHECK(texts(board.bus) == std::vector<std::string>{"71D#000000000000FFFF"});  // stays at its end
}

TEST_CASE("refusal: the board counts the samples that it could not take") {
  Board board;
  for (int i = 0; i < 3; ++i) board.receive("204#02", 0s);  // the floor sensors never answer in this fixture
  board.receive("31D#02", 1s);
  CHECK(texts(board.bus) == std::vector<std::string>{"71D#0000000003000000"});
}

TEST_CASE("status: what nothing is known of is zero, but for the load") {
  const auto status = controller::make_status<Status>({}, {});
  CHECK(status.encode(0) == can::Payload{});
  CHECK(status.health.load == controller::Health::unknown_load);
  CHECK(status.health == amiro::DiWheelDriveStatusHealth{.load = controller::Health::unknown_load});
  STATIC_REQUIRE(controller::Verdict{} == controller::Verdict{false, base::Error::none});
  STATIC_REQUIRE(controller::Refusal{} == controller::Refusal{protocol::TopicId{0}, base::Error::none});
  STATIC_REQUIRE(controller::Health{} == controller::Health{0, 255, 0, 0, 0});
}

TEST_CASE("status: bits by the order of the board's sensors") {
  // odometry, floor_proximity, magnetometer, gyroscope, accelerometer, status, refusal
  Board board;
  board.receive("208#01", 0s);
  board.receive("204#01", 0s);  // the floor sensors never answer in this fixture
  const Status status = ask_status(board, 10ms);
  CHECK(status.health.publishing == 0b1010);
  CHECK(status.health.faults == 0b0010);
  board.receive("204#00", 20ms);
  CHECK(ask_status(board, 30ms).health.publishing == 0b1000);
}

template <std::size_t... Number>
protocol::TopicList<Status, Part<Number>...> crowd(std::index_sequence<Number...>);
struct Crowded {  // 33 sensors
  using sensors = decltype(crowd(std::make_index_sequence<32>{}));
  using actuators = amiro::DiWheelDrive::actuators;
  using status = Status;
  using refusal = void;
  static constexpr std::uint32_t wire_hash = amiro::wire_hash;
};

TEST_CASE("status: a sensor that has no bit shows in none") {
  Mailboxes bus;
  controller::Controller<Crowded, Mailboxes> controller{bus};
  controller.serve<Part<31>>([] { return base::Result<Part<31>>{base::Error::no_answer}; });
  controller.receive(frame("25F#01"), at(0s));
  controller.poll(at(0s));
  CHECK(controller.active(32));
  CHECK(controller.counters().not_sampled == 1);
  controller.receive(frame("31B#02"), at(1ms));
  controller.poll(at(1ms));
  REQUIRE(bus.frames.size() == 2);
  const Status status = Status::decode({bus.frames[0].data, bus.frames[1].data});
  CHECK(status.health.publishing == 0);
  CHECK(status.health.faults == 0);
}

TEST_CASE("status: the first sensor has the lowest bit") {
  Board board;
  board.controller.serve<amiro::Odometry>(
      []() -> base::Result<amiro::Odometry> { return base::Error::no_answer; });
  board.receive("203#01", 0s);
  const Status status = ask_status(board, 2s);
  CHECK(status.health.publishing == 0b1);
  CHECK(status.health.faults == 0b1);
}

TEST_CASE("status: a part that answers again is no fault any more") {
  Board board;
  bool there = false;
  board.controller.serve<amiro::Accelerometer>([&there]() -> base::Result<amiro::Accelerometer> {
    if (!there) return base::Error::no_answer;
    return amiro::Accelerometer{};
  });
  board.receive("209#02", 0s);
  CHECK(ask_status(board, 1s).health.faults == 0b10000);
  there = true;
  board.receive("209#02", 2s);
  CHECK(ask_status(board, 3s).health.faults == 0);
}

TEST_CASE("status: overload and frames given up") {
  Board board;
  board.receive("208#010A0000", 0s);  // every 10 ms
  board.controller.poll(at(55ms));    // four are gone, the fifth is late
  CHECK(ask_status(board, 55ms).health.overload == 5);
  board.bus.broken = true;
  board.controller.poll(at(60ms));
  board.bus.broken = false;
  CHECK(ask_status(board, 60ms).health.bus_errors == 1);
}

TEST_CASE("status: a release that comes while the last sample still waits is overload, too") {
  Board board;
  board.bus.room = 2;
  board.receive("205#010A0000", 0s);  // every 10 ms, three frames: the last one waits
  board.bus.room = 10;
  board.controller.poll(at(35ms));  // those at 10, 20 and 30 ms are given up
  REQUIRE(board.controller.counters().overrun == 3);
  REQUIRE(board.controller.counters().missed + board.controller.counters().late == 0);
  CHECK(ask_status(board, 36ms).health.overload == 3);
}

TEST_CASE("status: it can be published like any other topic") {
  Board board;
  board.receive("31B#01", 0s);  // at its own period, 1 s
  CHECK(board.controller.next_event() == at(1s));
  board.controller.poll(at(1s));
  CHECK(board.bus.frames.size() == 4);
  CHECK((Status::decode({board.bus.frames[2].data, board.bus.frames[3].data}).health.publishing & 0b100000) !=
        0);
}

TEST_CASE("refusal: several in a row make one frame, with the last and the number of all") {
  Board board;
  board.bus.room = 0;
  board.receive("208#03", 0s);
  board.controller.receive(frame("209#09"), at(1ms));
  board.controller.receive(frame("205#"), at(2ms));
  board.bus.room = 10;
  board.controller.poll(at(3ms));
  // The first was on its way already.
  CHECK(texts(board.bus) == std::vector<std::string>{"71D#0804010000000000", "71D#0503030000000000"});
}

TEST_CASE("refusal: what turns out to be impossible later") {
  Board board;
  board.controller.refuse(amiro::FloorCalibration::id, base::Error::no_answer);
  board.controller.poll(at(0s));
  CHECK(texts(board.bus) == std::vector<std::string>{"71D#0A0D010000000000"});
  CHECK(board.controller.counters().failed == 1);
}

TEST_CASE("refusal: who publishes it is not cut off by one") {
  Board board;
  board.receive("31D#01", 0s);
  board.receive("208#03", 100ms);
  CHECK(board.controller.next_event() == at(1s));
  board.controller.poll(at(1s));
  CHECK(texts(board.bus) == std::vector<std::string>{"71D#0000000000000000", "71D#0804010000000000"});
}

TEST_CASE("status: eight bits for sensors, and errors of which there are more than a counter holds") {
  controller::Health health;
  health.bus_errors = 0xFFFF'FFFF;
  controller::Activity activity;
  activity.publishing = 0x181;
  activity.faults = 0x17E;
  activity.send_failed = 2;
  const auto status = controller::make_status<Status>(health, activity);
  CHECK(status.health.publishing == 0x81);
  CHECK(status.health.faults == 0x7E);
  CHECK(status.health.bus_errors == 65'535);
}

TEST_CASE("a number beyond its field stays at its end") {
  controller::Activity activity;
  activity.uptime = std::chrono::hours{24 * 365};
  activity.overload = 1'000'000;
  const auto status = controller::make_status<Status>({}, activity);
  CHECK(status.encode(0)[0] == 0xFF);
  CHECK(Status::decode({status.encode(0), status.encode(1)}).identity.uptime == 0xFFFFFF);
  CHECK(status.health.overload == 65'535);
}

}  // namespace controller_report_test
