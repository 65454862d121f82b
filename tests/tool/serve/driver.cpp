#include "cli/serve/driver.hpp"

#include <chrono>

#include <catch2/catch.hpp>

namespace serve_driver_test {

using namespace std::chrono_literals;
using ocm::can::Frame;
using ocm::cli::Clock;
using ocm::cli::serve::Driver;

constexpr Clock::time_point begin{1h};

ocm::client::Hold hold(int speed, std::uint32_t id = 0x201) {
  Frame frame;
  frame.id = id;
  frame.dlc = 8;
  Frame rest = frame;
  frame.data[0] = static_cast<std::uint8_t>(speed);
  return {frame, rest, {}};
}

TEST_CASE("driver: a set point is repeated while its viewer goes on, and rests behind it") {
  Driver driver;
  Driver::Frames out;
  CHECK(driver.drive(1, hold(5), begin, out).empty());
  REQUIRE(out.size() == 1);
  CHECK(out[0].data[0] == 5);
  CHECK(driver.next() == begin + 100ms);
  out.clear();
  CHECK_FALSE(driver.advance(begin + 99ms, out));
  CHECK(out.empty());
  // The same again keeps it going, and adds nothing to the bus.
  CHECK(driver.drive(1, hold(5), begin + 100ms, out).empty());
  CHECK(out.empty());
  CHECK_FALSE(driver.advance(begin + 100ms, out));
  REQUIRE(out.size() == 1);
  CHECK(out[0].data[0] == 5);
  out.clear();
  CHECK(driver.drive(1, hold(7), begin + 150ms, out).empty());  // another speed, at once
  REQUIRE(out.size() == 1);
  CHECK(out[0].data[0] == 7);
  out.clear();
  CHECK_FALSE(driver.advance(begin + 649ms, out));
  REQUIRE(out.size() == 1);
  CHECK(out[0].data[0] == 7);  // what is repeated is the last word
  out.clear();
  CHECK(driver.advance(begin + 650ms, out));  // half a second after its last word
  REQUIRE(out.size() == 1);
  CHECK(out[0] == hold(0).rest);
  CHECK_FALSE(driver.drives());
  CHECK_FALSE(driver.next());
}

TEST_CASE("driver: one drives at a time, and all may stop") {
  Driver driver;
  Driver::Frames out;
  REQUIRE(driver.drive(1, hold(5), begin, out).empty());
  out.clear();
  CHECK(driver.drive(2, hold(9), begin, out) == "another viewer drives; stop it first, or wait");
  CHECK(out.empty());
  CHECK(driver.drive(2, hold(9, 0x202), begin, out).empty());  // other motors
  out.clear();
  CHECK(driver.drive(2, hold(0), begin, out).empty());
  REQUIRE(out.size() == 1);
  CHECK(out[0] == hold(0).rest);
  CHECK_FALSE(driver.holds(0x201));
  CHECK(driver.holds(0x202));
  out.clear();
  CHECK(driver.drive(3, hold(0, 0x203), begin, out).empty());  // rest is never held back
  CHECK(out.size() == 1);
  out.clear();
  driver.rest(out);
  REQUIRE(out.size() == 1);
  CHECK(out[0] == hold(0, 0x202).rest);
  CHECK_FALSE(driver.drives());
}

TEST_CASE("driver: who was silent must say rest before it drives again") {
  Driver driver;
  Driver::Frames out;
  CHECK(driver.drive(1, hold(0), begin - 1s, out).empty());  // which it can say
  REQUIRE(driver.drive(1, hold(5), begin, out).empty());
  CHECK_FALSE(driver.must_rest(1, 0x201));
  REQUIRE(driver.advance(begin + 500ms, out));
  CHECK(driver.must_rest(1, 0x201));
  out.clear();
  // A page that was frozen goes on: what it says moves nothing; the first answer says why.
  CHECK(driver.drive(1, hold(5), begin + 3s, out) == "the drive was ended: release first, then drive again");
  CHECK(driver.drive(1, hold(5), begin + 3100ms, out).empty());
  CHECK_FALSE(driver.drives());
  CHECK(out.empty());
  CHECK(driver.drive(1, hold(6, 0x202), begin + 3200ms, out).empty());  // other motors
  CHECK(driver.drive(2, hold(7), begin + 3200ms, out).empty());         // another viewer
  CHECK(out.size() == 2);
  CHECK(driver.drive(2, hold(0), begin + 3200ms, out).empty());  // whose rest is not that of the first
  out.clear();
  CHECK(driver.drive(1, hold(5), begin + 3300ms, out).empty());
  CHECK(out.empty());
  CHECK(driver.drive(1, hold(0), begin + 3400ms, out).empty());  // released
  CHECK(out.size() == 1);
  CHECK_FALSE(driver.must_rest(1, 0x201));
  out.clear();
  CHECK(driver.drive(1, hold(5), begin + 3500ms, out).empty());
  REQUIRE(out.size() == 1);
  CHECK(out[0].data[0] == 5);
}

TEST_CASE("driver: a panel that is silent when released drives again when pressed again") {
  Driver driver;
  Driver::Frames out;
  for (const auto press : {0s, 2s, 4s}) {
    out.clear();
    CHECK(driver.drive(1, hold(5), begin + press, out).empty());
    CHECK(driver.drive(1, hold(5), begin + press + 100ms, out).empty());
    REQUIRE(out.size() == 1);
    CHECK(out[0].data[0] == 5);
    REQUIRE(driver.advance(begin + press + 600ms, out));
    CHECK(out.back() == hold(0).rest);
  }
  // Stopped by another: what is still pressed moves nothing, and the next press does.
  REQUIRE(driver.drive(1, hold(5), begin + 6s, out).empty());
  CHECK(driver.drive(2, hold(0), begin + 6010ms, out).empty());
  out.clear();
  for (int i = 1; i < 20; ++i) static_cast<void>(driver.drive(1, hold(5), begin + 6s + i * 100ms, out));
  CHECK(out.empty());
  CHECK(driver.drive(1, hold(5), begin + 8400ms, out).empty());
  CHECK(out.size() == 1);
}

TEST_CASE("driver: a stop by another holds against who goes on driving") {
  Driver driver;
  Driver::Frames out;
  REQUIRE(driver.drive(1, hold(5), begin, out).empty());
  CHECK(driver.drive(2, hold(0), begin + 10ms, out).empty());
  CHECK(driver.must_rest(1, 0x201));
  CHECK_FALSE(driver.must_rest(2, 0x201));
  out.clear();
  CHECK_FALSE(driver.drive(1, hold(5), begin + 100ms, out).empty());
  CHECK(driver.drive(1, hold(5), begin + 599ms, out).empty());  // said once
  CHECK(out.empty());
  CHECK(driver.drive(1, hold(0), begin + 700ms, out).empty());
  CHECK(driver.drive(1, hold(5), begin + 800ms, out).empty());
  CHECK(driver.drives());
  driver.rest(out);  // by another program
  CHECK(driver.must_rest(1, 0x201));
  driver.gone(1, out);
  CHECK_FALSE(driver.must_rest(1, 0x201));
  out.clear();
  CHECK(driver.drive(3, hold(5), begin + 400ms, out).empty());
  CHECK(driver.drive(3, hold(0), begin + 500ms, out).empty());
  CHECK_FALSE(driver.must_rest(3, 0x201));  // its own stop
}

TEST_CASE("driver: what a viewer drove rests when it has gone") {
  Driver driver;
  Driver::Frames out;
  REQUIRE(driver.drive(1, hold(5), begin, out).empty());
  REQUIRE(driver.drive(2, hold(6, 0x202), begin, out).empty());
  out.clear();
  driver.gone(1, out);
  REQUIRE(out.size() == 1);
  CHECK(out[0] == hold(0).rest);
  CHECK(driver.drives());
  out.clear();
  driver.gone(1, out);
  CHECK(out.empty());
}

TEST_CASE("driver: when something is due next") {
  Driver driver;
  Driver::Frames out;
  REQUIRE(driver.drive(1, hold(5), begin, out).empty());
  REQUIRE(driver.drive(2, hold(6, 0x202), begin + 30ms, out).empty());
  CHECK(driver.next() == begin + 100ms);
  CHECK_FALSE(driver.advance(begin + 100ms, out));
  CHECK(driver.next() == begin + 130ms);
  CHECK_FALSE(driver.advance(begin + 450ms, out));
  CHECK(driver.next() == begin + 500ms);  // the first one's silence, before either is repeated
  CHECK(driver.advance(begin + 500ms, out));
  CHECK(driver.next() == begin + 530ms);
  CHECK(driver.holds(0x202));
}

TEST_CASE(
    "driver: a new speed is not repeated before its time, and one that is said again is the newest word") {
  Driver driver;
  Driver::Frames out;
  REQUIRE(driver.drive(1, hold(5), begin, out).empty());
  REQUIRE(driver.drive(1, hold(7), begin + 90ms, out).empty());
  out.clear();
  CHECK_FALSE(driver.advance(begin + 189ms, out));
  CHECK(out.empty());
  CHECK_FALSE(driver.advance(begin + 190ms, out));
  CHECK(out.size() == 1);
  REQUIRE(driver.drive(1, hold(7), begin + 400ms, out).empty());
  CHECK_FALSE(driver.advance(begin + 899ms, out));
  CHECK(driver.advance(begin + 900ms, out));
  // Who has gone begins like any other.
  driver.gone(1, out);
  CHECK_FALSE(driver.must_rest(1, 0x201));
  CHECK(driver.drive(1, hold(5), begin + 901ms, out).empty());
  CHECK(driver.drives());
}

TEST_CASE("driver: its own rest ends only the motors that it is for") {
  Driver driver;
  Driver::Frames out;
  REQUIRE(driver.drive(1, hold(5), begin, out).empty());
  REQUIRE(driver.drive(1, hold(6, 0x202), begin, out).empty());
  REQUIRE(driver.drive(1, hold(0), begin + 10ms, out).empty());
  CHECK_FALSE(driver.holds(0x201));
  CHECK(driver.holds(0x202));
  driver.rest(out);
  CHECK(driver.must_rest(1, 0x202));
  CHECK_FALSE(driver.must_rest(1, 0x201));
  REQUIRE(driver.drive(1, hold(0), begin + 20ms, out).empty());
  CHECK(driver.must_rest(1, 0x202));
}

TEST_CASE("driver: of a viewer that has gone it is not known any more that it can say rest") {
  Driver driver;
  Driver::Frames out;
  REQUIRE(driver.drive(1, hold(0), begin, out).empty());
  driver.gone(1, out);
  REQUIRE(driver.drive(1, hold(5), begin + 1s, out).empty());
  REQUIRE(driver.advance(begin + 1500ms, out));
  CHECK(driver.drive(1, hold(5), begin + 3s, out).empty());  // a panel that was pressed again
  CHECK(driver.drives());
}

}  // namespace serve_driver_test
