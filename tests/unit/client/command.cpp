#include "ocm/client/command.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/can/text.hpp"
#include "ocm/topics/amiro.hpp"

namespace client_command_test {

using namespace ocm;
using client::set_point;
using client::stop_all;

const protocol::Topic& topic(std::string_view name) {
  return *amiro::catalogue.find(name);
}
std::string text(const can::Frame& frame) {
  return std::string{can::to_text(frame).view()};
}

TEST_CASE("a set point has the actuator's identifier, and zero where nothing is given") {
  CHECK(set_point(topic("motors"), {}) == set_point(topic("motors"), std::array<std::int64_t, 2>{0, 0}));
  CHECK(text(set_point(topic("led_1"), std::array<std::int64_t, 3>{100, 50, 120}, protocol::Priority::high))
            .ends_with("#643278"));
  // More values than fields: what has no field goes nowhere.
  CHECK(set_point(topic("led_1"), std::array<std::int64_t, 5>{1, 2, 3, 4, 5}) ==
        set_point(topic("led_1"), std::array<std::int64_t, 3>{1, 2, 3}));
}

TEST_CASE("a set point at rest has no byte but zeros") {
  CHECK(client::is_rest({0x201, 8, {}}));
  CHECK_FALSE(client::is_rest({0x201, 8, {0, 0, 0, 0, 0, 0, 0, 1}}));
  CHECK(client::is_rest({0x201, 2, {0, 0, 1}}));
}

TEST_CASE("a set point that is held comes in time for the board's watchdog") {
  // [spec/topics.json: watchdog of motors, 500 ms]
  CHECK(client::longest_without_set_point == std::chrono::milliseconds{500});
  CHECK(4 * client::hold_period < client::longest_without_set_point);
  // What goes on for longer without one, such as a travel, must be ended.
  CHECK(client::longest_watchdog == std::chrono::seconds{2});
  // Who listens hears the set point of another program that is late by half a period.
  CHECK(client::listen_before_hold == client::hold_period + client::hold_period / 2);
}

TEST_CASE("the priority of a set point is the topic's own unless one is given") {
  const auto& motors = topic("motors");
  CHECK(protocol::Identifier::decode(set_point(motors, {}).id).priority == motors.priority);
  CHECK(protocol::Identifier::decode(set_point(motors, {}, protocol::Priority::low).id).priority ==
        protocol::Priority::low);
}

TEST_CASE(
    "stopping all rests the motors first, then what rests by itself only later, and ends every stream") {
  const client::Command command = stop_all(amiro::catalogue);
  CHECK(command.ends_hold);
  CHECK_FALSE(command.hold);
  REQUIRE_FALSE(command.frames.empty());
  CHECK(command.frames[0] == set_point(topic("motors"), {}));
  std::size_t sensors = 0;
  for (const auto& one : amiro::catalogue.topics) {
    if (one.kind != protocol::Kind::sensor) continue;
    ++sensors;
    const auto stop = protocol::stop(one.id, one.priority);
    CHECK(std::count(command.frames.begin(), command.frames.end(), stop) == 1);
  }
  std::size_t behaviours = 0;
  for (const auto* name : {"travel", "follow", "avoid", "home"}) {
    ++behaviours;
    CHECK(command.frames[behaviours] == set_point(topic(name), {}));
  }
  CHECK(command.frames.size() == 1 + behaviours + sensors);
}

TEST_CASE("what is repeated leaves time to others") {
  CHECK(client::shortest_repeat == std::chrono::microseconds{100});
}

TEST_CASE("a command's frames, then those of CAN FD, then a broadcast from its announcement on") {
  protocol::FrameLayout layout;
  layout.length = 16;
  layout.address = {protocol::Address::By::pgn, true, 0x0CFE'CA2A};
  protocol::Topic message;
  message.name = "DM1";
  message.kind = protocol::Kind::message;
  message.frames = {&layout, 1};
  client::Broadcast broadcast;
  broadcast.message = &message;
  broadcast.data = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};
  CHECK(broadcast.id() == 0x0CFE'CA2A);
  CHECK(broadcast.frames() == 4);

  const can::Frame classic{0x201, 8, {}};
  can::AnyFrame fd;
  fd.id = 0x123;
  fd.length = 12;
  fd.flags = can::frame_flag::fd;
  client::Command command;
  CHECK_FALSE(command.ends_hold);
  command.frames.push_back(classic);
  command.fd_frames.push_back(fd);
  command.broadcast = broadcast;
  std::vector<can::AnyFrame> sent;
  command.each_frame([&sent](const can::AnyFrame& frame) { sent.push_back(frame); });
  REQUIRE(sent.size() == 6);
  CHECK(sent[0] == can::AnyFrame{classic});
  CHECK(sent[1] == fd);
  // As j1939/broadcast.hpp has them: 16 bytes in 3 packets, to all.
  const can::Frame parts[] = {
      {0x1CEC'FF2A, 8, {32, 16, 0, 3, 0xFF, 0xCA, 0xFE, 0x00}, can::Format::extended},
      {0x1CEB'FF2A, 8, {1, 1, 2, 3, 4, 5, 6, 7}, can::Format::extended},
      {0x1CEB'FF2A, 8, {2, 8, 9, 10, 11, 12, 13, 14}, can::Format::extended},
      {0x1CEB'FF2A, 8, {3, 15, 16, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF}, can::Format::extended}};
  for (std::size_t i = 0; i < 4; ++i) CHECK(sent[i + 2] == can::AnyFrame{parts[i]});
}

}  // namespace client_command_test
