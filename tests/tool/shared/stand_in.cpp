// A robot that is a log: what it answers to requests.
#include "cli/replay/stand_in.hpp"

#include <chrono>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/protocol/request.hpp"

#include "unit/protocol/example_topics.hpp"

namespace stand_in_test {

using namespace std::chrono_literals;
using namespace ocm;
using cli::replay::StandIn;
using protocol::Direction;
using protocol::Identifier;
using protocol::Mode;
using protocol::Priority;
using Answer = StandIn::Answer;

const protocol::Topic& scale = test::topics[0];
constexpr base::Time start{10s};

can::Frame frame(Direction direction, std::uint8_t topic, std::initializer_list<int> bytes,
                 Priority priority = Priority::high) {
  can::Frame frame;
  frame.id = Identifier{direction, priority, protocol::TopicId{topic}}.encode();
  for (const int byte : bytes) frame.data[frame.dlc++] = static_cast<std::uint8_t>(byte);
  return frame;
}

/// A stand-in that has learnt some samples of the scale, whose weights are 1, 2, 3, ...
struct Robot {
  explicit Robot(int samples) {
    for (int i = 1; i <= samples; ++i) {
      CHECK(robot.learn(frame(Direction::sensor, 0x10, {0, 0, 0, i})));
      CHECK(robot.learn(frame(Direction::sensor, 0x21, {i})));
    }
  }
  Answer ask(Mode mode, base::Duration period, Priority priority, base::Duration at) {
    return robot.take(
        protocol::encode(protocol::Request{test::Scale::id, mode, *protocol::Period::from(period), priority}),
        start + at);
  }
  /// Weights that are sent until then: "TIME:WEIGHT", in milliseconds.
  std::vector<std::string> until(base::Duration end) {
    std::vector<std::string> all;
    while (robot.next() != base::never && robot.next() < start + end) {
      const base::Time now = std::max(robot.next(), start);
      for (const can::Frame& each : robot.due(now))
        if (each.dlc == 4)
          all.push_back(std::to_string((now - start) / 1ms) + ":" + std::to_string(each.data[3]));
    }
    return all;
  }
  StandIn robot{test::catalogue};
};
using Strings = std::vector<std::string>;

TEST_CASE("stand-in: a period is answered with the samples in their order, and again from the first") {
  Robot robot{3};
  CHECK(robot.robot.samples() == 3);
  CHECK(robot.robot.samples(scale) == 3);
  CHECK(robot.robot.samples(test::topics[1]) == 0);
  CHECK(robot.robot.next() == base::never);
  CHECK(robot.robot.due(start).empty());
  CHECK(robot.ask(Mode::publish, 100ms, Priority::high, 0s) == Answer::accepted);
  const Strings said = robot.until(500ms);
  REQUIRE(said.size() >= 4);
  for (std::size_t i = 0; i < said.size(); ++i)
    CHECK(said[i].substr(said[i].find(':') + 1) == std::to_string(i % 3 + 1));
  CHECK(robot.ask(Mode::stop, 100ms, Priority::high, 500ms) == Answer::accepted);
  CHECK(robot.until(2s).empty());
}

TEST_CASE("stand-in: a sample is all of its frames, at the priority that was asked for") {
  Robot robot{2};
  CHECK(robot.ask(Mode::once, 100ms, Priority::urgent, 0s) == Answer::accepted);
  const auto frames = robot.robot.due(start);
  REQUIRE(frames.size() == 2);
  CHECK(frames[0] == frame(Direction::sensor, 0x10, {0, 0, 0, 1}, Priority::urgent));
  CHECK(frames[1] == frame(Direction::sensor, 0x21, {1}, Priority::urgent));
  CHECK(robot.until(5s).empty());  // once is once
  CHECK(robot.ask(Mode::once, 100ms, Priority::low, 1s) == Answer::accepted);
  CHECK(robot.robot.due(start + 1s).at(0).data[3] == 2);
}

TEST_CASE("stand-in: a request without a period has the topic's own, of a second") {
  Robot robot{1};
  can::Frame request = protocol::encode(
      protocol::Request{test::Scale::id, Mode::publish,
                        protocol::Period{100, protocol::PeriodUnit::milliseconds}, Priority::high});
  request.dlc = 1;
  CHECK(robot.robot.take(request, start) == Answer::accepted);
  const Strings said = robot.until(3500ms);
  CHECK(said.size() >= 3);
  CHECK(said.size() <= 4);
}

TEST_CASE("stand-in: what is no request, what no board takes, and what was not recorded") {
  Robot robot{1};
  CHECK(robot.robot.take(frame(Direction::sensor, 0x10, {0, 0, 0, 1}), start) == Answer::none);
  CHECK(robot.robot.take(frame(Direction::command, 0x30, {1}), start) == Answer::none);  // a lamp's set point
  CHECK(robot.robot.take(frame(Direction::command, 0x77, {1}), start) == Answer::none);
  can::Frame extended = frame(Direction::command, 0x10, {2});
  extended.format = can::Format::extended;
  CHECK(robot.robot.take(extended, start) == Answer::none);
  CHECK(robot.robot.take(frame(Direction::command, 0x10, {77}), start) == Answer::refused);
  CHECK(robot.robot.take(frame(Direction::command, 0x10, {1, 0, 0, 0}), start) == Answer::refused);
  CHECK(robot.robot.next() == base::never);
  Robot empty{0};
  CHECK(empty.robot.samples() == 0);
  CHECK(empty.ask(Mode::publish, 100ms, Priority::high, 0s) == Answer::silent);
  CHECK(empty.ask(Mode::stop, 100ms, Priority::high, 0s) == Answer::accepted);
  CHECK(empty.robot.next() == base::never);
}

TEST_CASE("stand-in: it learns as many frames as there is room for, and only whole samples") {
  for (const std::size_t room : {std::size_t{4}, std::size_t{5}}) {
    CAPTURE(room);
    StandIn robot{test::catalogue, room};
    for (int i = 1; i <= 3; ++i) {
      CHECK(robot.learn(frame(Direction::sensor, 0x10, {0, 0, 0, i})));
      CHECK(robot.learn(frame(Direction::sensor, 0x21, {i})) == (i <= 2));
    }
    CHECK(robot.samples() == 2);
  }
}

TEST_CASE("stand-in: half of a sample is none, and set points are not learnt") {
  Robot robot{0};
  CHECK(robot.robot.learn(frame(Direction::sensor, 0x10, {0, 0, 0, 1})));
  CHECK(robot.robot.learn(frame(Direction::sensor, 0x10, {0, 0, 0, 2})));
  CHECK(robot.robot.learn(frame(Direction::command, 0x30, {1})));
  CHECK(robot.robot.learn(frame(Direction::sensor, 0x7F, {1})));
  CHECK(robot.robot.samples() == 0);
  CHECK(robot.robot.learn(frame(Direction::sensor, 0x21, {1})));
  CHECK(robot.robot.samples() == 1);
}

TEST_CASE("stand-in: all that it learns takes 1 GB at most") {
  // A list that grows has room for as much again.
  CHECK(StandIn::most_frames * 2 * sizeof(can::Payload) == std::size_t{1} << 30);
}

TEST_CASE("stand-in: the first 256 topics of a spec are answered") {
  protocol::FrameLayout of_message, of_last;
  of_message.length = 8;
  of_message.address = {protocol::Address::By::identifier, true, 0x123};
  of_last.id = protocol::TopicId{0x11};
  of_last.length = 1;
  protocol::Topic message;
  message.kind = protocol::Kind::message;
  message.board = protocol::no_board;
  message.frames = {&of_message, 1};
  std::vector<protocol::Topic> topics(255, message);
  topics.push_back(scale);
  topics.push_back(scale);
  topics.back().id = of_last.id;
  topics.back().frames = {&of_last, 1};
  const protocol::Catalogue catalogue{"large", 250'000, test::boards, topics};
  StandIn robot{catalogue};
  CHECK(robot.learn(frame(Direction::sensor, 0x10, {0, 0, 0, 1})));
  CHECK(robot.learn(frame(Direction::sensor, 0x21, {1})));
  CHECK(robot.learn(frame(Direction::sensor, 0x11, {1})));
  CHECK(robot.samples(topics[255]) == 1);
  CHECK(robot.samples(topics[256]) == 1);
  const auto ask = [&robot](std::uint8_t topic) {
    return robot.take(protocol::encode(protocol::Request{protocol::TopicId{topic}, Mode::once,
                                                         protocol::default_period, Priority::high}),
                      start);
  };
  CHECK(ask(0x11) == Answer::silent);
  CHECK(robot.next() == base::never);
  CHECK(ask(0x10) == Answer::accepted);
  CHECK(robot.due(start).size() == 2);
}

}  // namespace stand_in_test
