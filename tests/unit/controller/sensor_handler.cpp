#include "ocm/controller/sensor_handler.hpp"

#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "unit/controller/fixture.hpp"

namespace controller_sensor_handler_test {

using namespace fixture;

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
  CHECK(board.controller.next_event() == at(50ms));
  board.receive("205#00", 0s);
  // That is also what a request without a period says; the status has another.
  board.receive("31B#01", 0s);
  CHECK(board.controller.next_event() == at(1s));
  board.receive("31B#01640000", 0s);  // and with one that holds
  CHECK(board.controller.next_event() == at(100ms));
}

template <std::size_t... Number>
protocol::TopicList<Part<Number>...> parts(std::index_sequence<Number...>);

TEST_CASE("faults: a bit for each of the first 32 sensors, and none for those behind them") {
  controller::SensorHandler<decltype(parts(std::make_index_sequence<33>{}))> handler;
  handler.serve<Part<0>>([](base::Time) { return base::Result<Part<0>>{base::Error::no_answer}; });
  handler.serve<Part<31>>([](base::Time) { return base::Result<Part<31>>{base::Error::no_answer}; });
  handler.serve<Part<32>>([](base::Time) { return base::Result<Part<32>>{base::Error::no_answer}; });
  scheduling::Cooperative port;
  Mailboxes bus;
  protocol::Counters counters;
  const auto faults_after = [&](std::size_t sensor) {
    const scheduling::Release release{.stream = sensor};
    CHECK(handler.run(sensor, release, port, bus, counters) == scheduling::Outcome::done);
    return handler.faults();
  };
  CHECK(faults_after(32) == 0);
  CHECK(faults_after(31) == 0x8000'0000);
  CHECK(faults_after(0) == 0x8000'0001);
  CHECK(counters.not_sampled == 3);
}

/// Remembers what it was asked and told.
struct Bookkeeper {
  struct Entry {
    std::size_t stream;
    base::Duration period;  // 0: it has ended
    scheduling::Level level;
    friend bool operator==(const Entry&, const Entry&) = default;
  };
  static inline std::vector<Entry> entries;  // a controller makes its own admission
  static base::Error admit(std::size_t stream, base::Duration period, scheduling::Level level) {
    entries.push_back({stream, period, level});
    return period < 1ms ? base::Error::not_schedulable : base::Error::none;
  }
  static void ended(std::size_t stream) { entries.push_back({stream, {}, scheduling::Level::urgent}); }
};

TEST_CASE("the admission is asked for each stream, and told when one has ended") {
  using Entries = std::vector<Bookkeeper::Entry>;
  Bookkeeper::entries.clear();
  Mailboxes bus;
  controller::Controller<amiro::DiWheelDrive, Mailboxes, scheduling::Cooperative, 0, Bookkeeper> controller{
      bus};
  controller.serve<amiro::Gyroscope>([] { return base::Result<amiro::Gyroscope>{amiro::Gyroscope{}}; });
  constexpr std::size_t gyroscope = amiro::DiWheelDrive::sensors::index<amiro::Gyroscope>;
  const auto said = [&](std::string_view text) {
    controller.receive(frame(text), at(0s));
    return std::exchange(Bookkeeper::entries, {});
  };
  CHECK(said("108#01F40100") == Entries{{gyroscope, 500ms, scheduling::Level::high}});
  CHECK(said("208#01") == Entries{{gyroscope, 50ms, scheduling::Level::medium}});
  constexpr std::size_t status = amiro::DiWheelDrive::sensors::index<amiro::DiWheelDriveStatus>;
  CHECK(said("31B#01") == Entries{{status, 1s, scheduling::Level::low}});
  CHECK(said("208#00") == Entries{{gyroscope, 0ms, scheduling::Level::urgent}});
  CHECK(said("208#01F40100") == Entries{{gyroscope, 500ms, scheduling::Level::medium}});
  CHECK(said("208#02") == Entries{{gyroscope, 0ms, scheduling::Level::urgent}});
  // What is refused has not ended what runs, and what cannot be carried out is not asked.
  CHECK(said("208#01F40102") == Entries{{gyroscope, 500us, scheduling::Level::medium}});
  CHECK(said("208#0000").empty());
  CHECK(said("209#01").empty());  // nothing serves it
}

TEST_CASE("a stream that the admission refuses is counted, told, and leaves the one that runs") {
  Mailboxes bus;
  controller::Controller<amiro::DiWheelDrive, Mailboxes, scheduling::Cooperative, 0, Bookkeeper> controller{
      bus};
  controller.serve<amiro::Gyroscope>([] { return base::Result<amiro::Gyroscope>{amiro::Gyroscope{}}; });
  controller.receive(frame("208#01F40100"), at(0s));
  controller.poll(at(0s));
  controller.receive(frame("308#01F40102"), at(100ms));  // every 500 us
  controller.poll(at(100ms));
  CHECK(controller.counters().not_schedulable == 1);
  CHECK(controller.counters().refused() == 1);
  CHECK(controller.counters().requests == 1);
  REQUIRE(bus.frames.size() == 2);
  CHECK(texts(bus)[1].substr(0, 6) == "71D#08");
  CHECK(bus.frames[1].data[1] == static_cast<std::uint8_t>(base::Error::not_schedulable));
  CHECK(controller.next_event() == at(500ms));
  controller.poll(at(500ms));
  CHECK(texts(bus)[2] == "608#000000000000");
  CHECK(controller.next_event() == at(1s));
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

TEST_CASE("a release is late beyond the topic's jitter, not at it") {
  Board board;
  board.receive("208#01640000", 0s);  // every 100 ms
  board.controller.poll(at(100ms + amiro::Gyroscope::jitter));
  CHECK(board.controller.counters().late == 0);
  board.controller.poll(at(200ms + amiro::Gyroscope::jitter + 1ns));
  CHECK(board.controller.counters().late == 1);
  board.controller.poll(at(520ms));  // those at 300 and 400 are gone
  CHECK(board.controller.counters().missed == 2);
}

TEST_CASE("a stop lets a sample that is half sent finish") {
  Board board;
  board.bus.room = 1;
  board.receive("205#010A0000", 0s);
  board.receive("205#00", 1ms);
  board.bus.room = 10;
  board.controller.poll(at(2ms));
  CHECK(board.bus.frames.size() == 3);
  board.controller.poll(at(1s));
  CHECK(board.bus.frames.size() == 3);
}

}  // namespace controller_sensor_handler_test
