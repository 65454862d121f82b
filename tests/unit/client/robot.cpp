#include "ocm/client/robot.hpp"

#include <deque>

#include <catch2/catch.hpp>

#include "ocm/can/text.hpp"
#include "ocm/topics/amiro.hpp"

namespace client_robot_test {

using namespace ocm;
using namespace std::chrono_literals;

/// A bus that remembers what was sent and plays back what a robot would answer.
struct Tape {
  base::Result<bool> send(const can::Frame& frame) {
    sent.emplace_back(can::to_text(frame).view());
    return room;
  }
  base::Result<can::Received> receive(base::Duration limit) {
    limits.push_back(limit);
    if (answers.empty()) return base::Error::timed_out;
    const auto frame = can::parse_frame(answers.front());
    answers.pop_front();
    return can::Received{base::Time{1s}, *frame};
  }
  bool room = true;
  std::vector<std::string> sent;
  std::deque<std::string> answers;
  std::vector<base::Duration> limits;  ///< how long it was to wait
};

static_assert(client::SensorType<amiro::Gyroscope> && !client::SensorType<amiro::Motors>);
static_assert(client::ActuatorType<amiro::Motors> && !client::ActuatorType<amiro::Gyroscope>);
static_assert(!client::SensorType<int> && !client::ActuatorType<int>);

TEST_CASE("requests and set points by type") {
  Tape bus;
  client::Robot robot{bus, amiro::catalogue};
  CHECK(robot.publish<amiro::Gyroscope>(500ms, protocol::Priority::high).ok());
  CHECK(robot.once<amiro::PowerStatus>().ok());
  CHECK(robot.stop<amiro::Gyroscope>().ok());
  CHECK(robot.set(amiro::Motors{50'000, 0}).ok());
  CHECK(robot.set(amiro::Led{255, 0, 0}, 8).ok());
  CHECK(bus.sent ==
        std::vector<std::string>{"108#01F40100", "21E#02", "208#00", "201#50C3000000000000", "243#FF0000"});
}

TEST_CASE("what cannot be sent is an error, and nothing is sent") {
  Tape bus;
  client::Robot robot{bus, amiro::catalogue};
  CHECK(robot.publish<amiro::Gyroscope>(1ns).error == base::Error::bad_period);
  CHECK(robot.set(amiro::Led{}, 0).error == base::Error::out_of_range);
  CHECK(robot.set(amiro::Led{}, 9).error == base::Error::out_of_range);
  CHECK(bus.sent.empty());
  bus.room = false;
  CHECK(robot.once<amiro::Gyroscope>().error == base::Error::full);
}

TEST_CASE("next gives complete samples only") {
  Tape bus;
  bus.answers = {"208#02", "605#00D20000", "608#3E001E00FCFF"};
  client::Robot robot{bus, amiro::catalogue};
  const auto sample = robot.next(1s);
  REQUIRE(sample.ok());
  CHECK(sample->as<amiro::Gyroscope>().ok());
  CHECK(robot.next(1s).error == base::Error::timed_out);
  CHECK(robot.counters().commands == 1);
}

TEST_CASE("next waits no longer than it is to, whatever comes meanwhile") {
  Tape bus;
  bus.answers = {"208#02", "208#02"};
  client::Robot robot{bus, amiro::catalogue};
  CHECK(robot.next(1s).error == base::Error::timed_out);
  REQUIRE(bus.limits.size() == 3);
  CHECK(bus.limits[0] == 1s);
  CHECK(bus.limits[1] <= bus.limits[0]);
  CHECK(bus.limits[2] <= bus.limits[1]);
  bus.answers = {"208#02"};
  CHECK(robot.next(0s).error == base::Error::timed_out);
  CHECK(bus.limits.back() == 0s);
}

}  // namespace client_robot_test
