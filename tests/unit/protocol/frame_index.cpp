#include "ocm/protocol/frame_index.hpp"

#include <catch2/catch.hpp>

#include "unit/protocol/example_topics.hpp"

namespace protocol_frame_index_test {

using ocm::protocol::Direction;
using ocm::protocol::FrameIndex;
using ocm::protocol::Identifier;
using ocm::protocol::Priority;
using ocm::protocol::TopicId;
using ocm::test::catalogue;

constexpr FrameIndex frame_index{catalogue};

constexpr Identifier sensor(int topic) {
  return {Direction::sensor, Priority::medium, TopicId{static_cast<std::uint8_t>(topic)}};
}
constexpr Identifier to_board(int topic, Priority priority = Priority::medium) {
  return {Direction::command, priority, TopicId{static_cast<std::uint8_t>(topic)}};
}

TEST_CASE("the index knows every identifier that means something, and no other") {
  for (unsigned number = 0; number <= ocm::can::max_base_id; ++number) {
    const Identifier id = Identifier::decode(number);
    const int topic = id.topic.value;
    const bool command = id.direction == Direction::command;
    INFO(number);
    const auto ref = frame_index.find(id);
    if (!command && (topic == 0x10 || topic == 0x21)) {
      REQUIRE(ref);
      REQUIRE(ref.topic == &catalogue.topics[0]);
      REQUIRE(ref.frame == (topic == 0x10 ? 0 : 1));
      REQUIRE(&ref.layout() == &ocm::test::scale_frames[ref.frame]);
    } else if (command && topic >= 0x30 && topic <= 0x32) {
      REQUIRE(ref);
      REQUIRE(ref.topic == &catalogue.topics[static_cast<std::size_t>(topic - 0x30 + 1)]);
      REQUIRE(&ref.layout() == &ocm::test::lamp_frames[static_cast<std::size_t>(topic - 0x30)]);
    } else {
      REQUIRE_FALSE(ref);
    }
    REQUIRE(frame_index.requested(id) == (command && topic == 0x10 ? &catalogue.topics[0] : nullptr));
  }
}

TEST_CASE("a request is no sample, and a set point is no request") {
  CHECK_FALSE(frame_index.find(to_board(0x10)));
  CHECK(frame_index.requested(to_board(0x10, Priority::urgent)) != nullptr);
  CHECK(frame_index.requested(sensor(0x10)) == nullptr);
  CHECK(frame_index.requested(to_board(0x30)) == nullptr);
  CHECK_FALSE(frame_index.find(sensor(0x30)));
}

TEST_CASE("an index of nothing finds nothing") {
  constexpr FrameIndex empty;
  STATIC_REQUIRE_FALSE(empty.find(sensor(0x10)));
  STATIC_REQUIRE(empty.requested(to_board(0x10)) == nullptr);
  constexpr FrameIndex of_nothing{ocm::protocol::Catalogue{}};
  STATIC_REQUIRE_FALSE(of_nothing.find(sensor(0x10)));
}

TEST_CASE("the subject of a frame is a request, a frame of a topic, or unknown") {
  const auto request = frame_index.subject(to_board(0x10));
  CHECK(request.is_request());
  CHECK(request.topic == &catalogue.topics[0]);
  CHECK_FALSE(request.frame);
  const auto data = frame_index.subject(sensor(0x10));
  CHECK_FALSE(data.is_request());
  CHECK(data.topic == &catalogue.topics[0]);
  CHECK(data.frame.topic == data.topic);
  const auto set_point = frame_index.subject(to_board(0x30));
  CHECK_FALSE(set_point.is_request());
  CHECK(set_point.topic == &catalogue.topics[1]);
  const auto unknown = frame_index.subject(sensor(0x30));
  CHECK_FALSE(unknown);
  CHECK_FALSE(unknown.is_request());
}

}  // namespace protocol_frame_index_test
