#include "ocm/client/refusals.hpp"

#include <chrono>
#include <optional>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/client/command.hpp"
#include "ocm/protocol/message.hpp"
#include "ocm/topics/amiro.hpp"

namespace client_refusals_test {

using namespace ocm;
using namespace ocm::client;
using namespace std::chrono_literals;
using Reason = amiro::DiWheelDriveRefusal::Reason;

const can::Frame publish_mag = *protocol::publish_every(amiro::Magnetometer::id, 900us);
const can::Frame drive = protocol::command(amiro::Motors{1, 0});

/// A program that has sent something, and the robot's answers.
struct Program {
  Refusals refusals{amiro::catalogue};
  base::Time now{10s};

  void send(const can::Frame& frame) { refusals.sent(frame, now); }
  template <class T>
  std::optional<Refused> hear(const T& refusal, base::Duration after) {
    return refusals.take({{}, protocol::sample_frame(refusal, protocol::Priority::low, 0)}, now + after);
  }
  std::optional<Refused> hear(std::uint8_t number, Reason reason, std::uint16_t count,
                              base::Duration after = 1ms) {
    return hear(amiro::DiWheelDriveRefusal{number, reason, count, 0}, after);
  }
};

TEST_CASE("refusals: of a request and of a set point") {
  Program program;
  program.send(publish_mag);
  const auto late = program.hear(0x05, Reason::not_schedulable, 1);
  REQUIRE(late);
  CHECK(late->topic->name == "magnetometer");
  CHECK(late->board == "di_wheel_drive");
  CHECK(late->reason == "not_schedulable");
  program.send(drive);
  const auto motors = program.hear(0x01, Reason::bad_length, 2);
  REQUIRE(motors);
  CHECK(motors->topic->name == "motors");
  CHECK(motors->reason == "bad_length");
}

TEST_CASE("refusals: of one of several actuators of a kind") {
  Program program;
  program.send(set_point(*amiro::catalogue.find("led_4"), {}));
  CHECK(!program.hear(amiro::LightRingRefusal{0x3C, amiro::LightRingRefusal::Reason::not_served, 1, 0}, 1ms));
  const auto led =
      program.hear(amiro::LightRingRefusal{0x3F, amiro::LightRingRefusal::Reason::not_served, 2, 0}, 1ms);
  REQUIRE(led);
  CHECK(led->topic->name == "led_4");
  CHECK(led->board == "light_ring");
}

TEST_CASE("refusals: of the highest number that a topic can have") {
  constexpr protocol::TopicId highest{0xFF};
  std::vector<protocol::Topic> topics{amiro::catalogue.topics.begin(), amiro::catalogue.topics.end()};
  for (protocol::Topic& topic : topics)
    if (topic.name == "magnetometer") topic.id = highest;
  protocol::Catalogue catalogue = amiro::catalogue;
  catalogue.topics = topics;
  Refusals refusals{catalogue};
  refusals.sent(*protocol::publish_every(highest, 1ms), base::Time{10s});
  const amiro::DiWheelDriveRefusal refusal{0xFF, Reason::not_schedulable, 1, 0};
  const auto refused =
      refusals.take({{}, protocol::sample_frame(refusal, protocol::Priority::low, 0)}, base::Time{10s + 1ms});
  REQUIRE(refused);
  CHECK(refused->topic->name == "magnetometer");
  CHECK(refused->number == 0xFF);
}

TEST_CASE("refusals: of what another program has sent are not this one's") {
  Program program;
  CHECK(!program.hear(0x05, Reason::not_schedulable, 1));  // nothing was sent
  program.send(publish_mag);
  CHECK(!program.hear(0x08, Reason::not_schedulable, 2));
  CHECK(!program.hear(amiro::PowerManagementRefusal{0x05, {}, 1, 0}, 1ms));  // of another board
}

TEST_CASE("refusals: frames of no topic, other samples and reports of the controller are none") {
  Program program;
  program.send(publish_mag);
  for (const can::Frame& frame :
       {can::Frame{.id = 0x7FF}, can::Frame{.id = 0x605, .format = can::Format::extended},
        can::Frame{.id = 4, .dlc = 8, .format = can::Format::error},
        protocol::sample_frame(amiro::Gyroscope{}, protocol::Priority::low, 0)})
    CHECK(!program.refusals.take({{}, frame}, program.now));
  CHECK(program.hear(0x05, Reason::not_schedulable, 1));
}

TEST_CASE("refusals: one that was heard before is not news when it is published again") {
  Program program;
  CHECK(!program.hear(0x05, Reason::not_schedulable, 7));
  program.send(publish_mag);
  CHECK(!program.hear(0x05, Reason::not_schedulable, 7));
  CHECK(program.hear(0x05, Reason::not_schedulable, 8));
  CHECK(!program.hear(0x05, Reason::not_schedulable, 8));
}

TEST_CASE("refusals: one that comes later than the topic's deadline is another program's") {
  Program program;
  program.send(publish_mag);
  CHECK(program.hear(0x05, Reason::not_schedulable, 1, 1s + refusal_patience));
  CHECK(!program.hear(0x05, Reason::not_schedulable, 2, 1s + refusal_patience + 1ns));
  // What is held is sent again, and may be refused at any time.
  static_cast<void>(program.refusals.repeated(publish_mag, program.now + 5s));
  CHECK(program.hear(0x05, Reason::not_schedulable, 3, 5s + 1ms));
}

TEST_CASE("refusals: for how long to listen") {
  Program program;
  CHECK(program.refusals.listen_until() < program.now);
  program.send(publish_mag);
  CHECK(program.refusals.listen_until() == program.now + 100ms);
  // Not after what no board answers with a refusal: sensor data, other formats, numbers of no topic, and a
  // refusal topic itself, whose sample is the answer.
  program.now += 1h;
  program.send({.id = 0x605, .dlc = 4});
  program.send({.id = 0x205, .format = can::Format::extended});
  program.send({.id = 0x2FF});
  program.send(protocol::once(amiro::DiWheelDriveRefusal::id));
  CHECK(program.refusals.listen_until() < program.now);
  CHECK(program.refusals.repeated(drive, program.now));
  CHECK(program.refusals.listen_until() < program.now);
  program.send(drive);
  CHECK(program.refusals.listen_until() == program.now + 100ms);
}

TEST_CASE("refusals: a robot without refusal topics has none") {
  constexpr protocol::Catalogue bare{"bare", 500'000, amiro::catalogue.boards,
                                     amiro::catalogue.topics.first(3)};
  Refusals refusals{bare};
  refusals.sent(publish_mag, base::Time{1s});
  CHECK(refusals.refusal_topic(publish_mag) == nullptr);
  CHECK(refusals.listen_until() == base::Time::min());
}

TEST_CASE("refusals: a reason without a name in the spec") {
  Program program;
  program.send(publish_mag);
  const auto refused = program.hear(0x05, Reason{200}, 1);
  REQUIRE(refused);
  CHECK(refused->reason.empty());
}

}  // namespace client_refusals_test
