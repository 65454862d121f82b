// Who moves the robot, as frames on the bus show it.
#include <array>
#include <initializer_list>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/client/command.hpp"
#include "ocm/protocol/request.hpp"
#include "ocm/topics/amiro.hpp"

#include "cli/shared/behaviour_sensor.hpp"
#include "cli/shared/set_points.hpp"
#include "unit/protocol/example_topics.hpp"

namespace motors_test {

using namespace ocm;
using namespace ocm::cli;

can::Frame frame(std::uint32_t id, std::uint8_t length, std::uint8_t first = 0) {
  can::Frame frame;
  frame.id = id;
  frame.dlc = length;
  frame.data[0] = first;
  return frame;
}

TEST_CASE("motors: a set point of theirs, at any priority, and nothing else") {
  const client::FrameIndex index{amiro::catalogue};
  const auto name = [&](const can::Frame& frame) {
    const protocol::Topic* const topic = commanded_motors(index, frame);
    return topic == nullptr ? std::string_view{} : topic->name;
  };
  for (const std::uint32_t id : {0x001U, 0x201U, 0x301U}) CHECK(name(frame(id, 8)) == "motors");
  CHECK(name(frame(0x601, 8)).empty());  // a sensor's direction
  CHECK(name(frame(0x201, 7)).empty());
  CHECK(name(frame(0x23C, 3)).empty());  // a light
  CHECK(name(frame(0x208, 4)).empty());  // a request
  can::Frame extended = frame(0x201, 8);
  extended.format = can::Format::extended;
  CHECK(name(extended).empty());
}

TEST_CASE("motors: what a board does by itself, by its name") {
  const BehaviourSensor sensor{amiro::catalogue};
  const client::FrameIndex index{amiro::catalogue};
  REQUIRE(sensor.exists());
  CHECK(sensor.topic().name == "behaviour");
  CHECK(sensor.active().name == "active");
  CHECK(sensor.ended().name == "ended");
  CHECK(sensor.active_in(index, frame(0x60D, 8)) == std::string_view{});
  CHECK(sensor.active_in(index, frame(0x60D, 8, 1)) == "travel");
  CHECK(sensor.active_in(index, frame(0x60D, 8, 2)) == "follow");
  CHECK(sensor.active_in(index, frame(0x60D, 8, 77)) == "an unknown behaviour");
  CHECK_FALSE(sensor.active_in(index, frame(0x60D, 7, 1)));
  CHECK_FALSE(sensor.active_in(index, frame(0x608, 6, 1)));
  CHECK_FALSE(sensor.active_in(index, frame(0x20D, 4, 1)));  // a request to it
  const can::Frame request = sensor.request();
  CHECK(request == protocol::once(protocol::TopicId{0x0D}, sensor.topic().priority));
}

TEST_CASE("motors: the behaviour that a frame commands") {
  const BehaviourSensor sensor{amiro::catalogue};
  const client::FrameIndex index{amiro::catalogue};
  const auto commanded = [&](const protocol::Topic& topic) {
    return sensor.commanded(index, client::set_point(topic, {}, {}));
  };
  for (const char* const name : {"travel", "follow"}) {
    const protocol::Topic& topic = *amiro::catalogue.find(name);
    CHECK(commanded(topic) == &topic);
    can::Frame other = client::set_point(topic, {}, {});
    other.dlc = 1;
    CHECK(sensor.commanded(index, other) == nullptr);
    other = client::set_point(topic, {}, {});
    other.format = can::Format::extended;
    CHECK(sensor.commanded(index, other) == nullptr);
    other = client::set_point(topic, {}, {});
    other.id |= 0x400;
    CHECK(sensor.commanded(index, other) == nullptr);
  }
  CHECK(commanded(*amiro::catalogue.find("motors")) == nullptr);
  CHECK(commanded(*amiro::catalogue.find("avoid")) ==
        nullptr);  // another board's, which that sensor does not name
}

TEST_CASE("motors: a spec without that sensor, or with another one of its name, has none") {
  CHECK_FALSE(BehaviourSensor{test::catalogue}.exists());
  const client::FrameIndex index{test::catalogue};
  CHECK_FALSE(BehaviourSensor{test::catalogue}.active_in(index, frame(0x60D, 8, 1)));
  CHECK(BehaviourSensor{test::catalogue}.commanded(index, frame(0x230, 1)) == nullptr);
  // Of two frames, and one without how it ended.
  std::array<protocol::Topic, 1> topics{test::topics[0]};
  topics[0].name = "behaviour";
  const protocol::Catalogue two_frames{"robot", 250'000, test::boards, topics};
  CHECK_FALSE(BehaviourSensor{two_frames}.exists());
  auto fields = test::lamp_fields;
  fields[0].name = "active";
  const std::array<protocol::FrameLayout, 1> frames{{{"", protocol::TopicId{0x10}, 1, fields}}};
  topics[0].frames = frames;
  const protocol::Catalogue without_end{"robot", 250'000, test::boards, topics};
  CHECK_FALSE(BehaviourSensor{without_end}.exists());
}

TEST_CASE("motors: zeros end a motion of theirs, or what a board does by itself, and no light") {
  const auto ends = [](const char* name, std::int64_t first) {
    const protocol::Topic& topic = *amiro::catalogue.find(name);
    std::vector<std::int64_t> raw(topic.frames[0].fields.size(), 0);
    raw[0] = first;
    return ends_motion(topic, client::set_point(topic, raw));
  };
  for (const char* const name : {"motors", "travel"}) {
    CAPTURE(name);
    CHECK(ends(name, 0));
    CHECK_FALSE(ends(name, 1));
  }
  CHECK_FALSE(ends("led_1", 0));
  CHECK_FALSE(ends("led_1", 1));
}

TEST_CASE("motors: a rest of what no watchdog ends, such as a travel, is the end of one") {
  const auto ends = [](std::initializer_list<std::pair<const char*, std::int64_t>> set_points) {
    client::Command command;
    for (const auto& [name, first] : set_points) {
      const protocol::Topic& topic = *amiro::catalogue.find(name);
      std::vector<std::int64_t> raw(topic.frames[0].fields.size(), 0);
      raw[0] = first;
      command.frames.push_back(client::set_point(topic, raw));
    }
    return ends_travel(amiro::catalogue, command);
  };
  CHECK_FALSE(ends({}));
  CHECK(ends({{"travel", 0}}));
  CHECK(ends({{"led_1", 1}, {"travel", 0}}));
  CHECK_FALSE(ends({{"travel", 1}}));
  for (const char* const other : {"motors", "follow", "led_1"}) {
    CAPTURE(other);
    CHECK_FALSE(ends({{other, 0}}));
  }
  client::Command unknown;
  unknown.frames.push_back(frame(0x7FF, 1));
  CHECK_FALSE(ends_travel(amiro::catalogue, unknown));
}

}  // namespace motors_test
