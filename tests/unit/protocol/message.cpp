#include "ocm/protocol/message.hpp"

#include <catch2/catch.hpp>

#include "ocm/can/text.hpp"

#include "unit/protocol/example_topics.hpp"

namespace protocol_message_test {

using ocm::can::Frame;
using ocm::protocol::command;
using ocm::protocol::frame_id;
using ocm::protocol::message_frame;
using ocm::protocol::message_from;
using ocm::protocol::Priority;
using ocm::protocol::sample_frame;
using ocm::protocol::TopicId;
using ocm::test::Lamp;
using ocm::test::Scale;

constexpr Frame frame(const char* text) {
  return *ocm::can::parse_frame(text);
}

TEST_CASE("a sample's frames carry its topic's identifiers and lengths, as sensor data") {
  constexpr Scale sample{0x01020304, 0x81};
  STATIC_REQUIRE(sample_frame(sample) == frame("510#01020304"));  // the topic's own priority: high
  STATIC_REQUIRE(sample_frame(sample, Priority::urgent, 1) == frame("421#81"));
  STATIC_REQUIRE(sample_frame(sample, Priority::low, 0) == frame("710#01020304"));
}

TEST_CASE("a set point is one command frame, on the identifier of its instance") {
  STATIC_REQUIRE(command(Lamp{7}) == frame("330#07"));  // the topic's own priority: low
  STATIC_REQUIRE(command(Lamp{7}, Priority::high, 3) == frame("132#07"));
}

TEST_CASE("instances follow each other; frames have the identifiers that they were given") {
  STATIC_REQUIRE(frame_id<Lamp>(0) == TopicId{0x30});
  STATIC_REQUIRE(frame_id<Lamp>(0, 2) == TopicId{0x31});
  STATIC_REQUIRE(frame_id<Scale>(0) == TopicId{0x10});
  STATIC_REQUIRE(frame_id<Scale>(1) == TopicId{0x21});
}

TEST_CASE("a sample comes back from its frames") {
  constexpr Scale sample{-123456, 0x80};
  STATIC_REQUIRE(Scale::decode({sample_frame(sample).data, sample_frame(sample, Priority::low, 1).data}) ==
                 sample);
}

/// As the generator writes them.
template <ocm::protocol::Address::By By, bool Extended, std::uint32_t Number>
struct Plain {
  static constexpr ocm::protocol::Address address{By, Extended, Number};
  static constexpr std::size_t length = 2;
  static constexpr bool fd = false;
  std::array<std::uint8_t, 8> bytes{0x12, 0x34};
};
using By = ocm::protocol::Address::By;
using Short = Plain<By::identifier, false, 0x123>;
using Wide = Plain<By::identifier, true, 0x123>;
using Group = Plain<By::pgn, true, 0x18F0'04FE>;

TEST_CASE("a plain message is its bytes, in a frame of its identifier") {
  STATIC_REQUIRE(message_frame(Short{}) == frame("123#1234"));
  STATIC_REQUIRE(message_frame(Wide{}) == frame("00000123#1234"));
  STATIC_REQUIRE(message_from<Short>(frame("123#ABCD"))->bytes[1] == 0xCD);
  STATIC_REQUIRE(message_from<Short>(frame("123#ABCDEF"))->bytes[2] == 0);  // beyond it, and without meaning
  STATIC_REQUIRE(!message_from<Short>(frame("123#AB")));
  STATIC_REQUIRE(!message_from<Short>(frame("124#ABCD")));
  STATIC_REQUIRE(!message_from<Short>(frame("00000123#ABCD")));
  STATIC_REQUIRE(!message_from<Wide>(frame("123#ABCD")));
  STATIC_REQUIRE(!message_from<Short>(frame("123#R2")));
}

struct Full : Short {
  static constexpr std::size_t length = 8;
};
struct Long : Short {
  static constexpr std::size_t length = 9;
};
struct Fast : Short {
  static constexpr bool fd = true;
};
template <class T>
concept HasFrame = requires(const T& message) {
  message_frame(message);
};

TEST_CASE("a message of more than eight bytes, or of CAN FD, has no classic frame") {
  STATIC_REQUIRE(HasFrame<Short>);
  STATIC_REQUIRE(HasFrame<Full>);
  STATIC_REQUIRE_FALSE(HasFrame<Long>);
  STATIC_REQUIRE_FALSE(HasFrame<Fast>);
}

TEST_CASE("a message of J1939 is its parameter group, from any sender") {
  STATIC_REQUIRE(message_from<Group>(frame("0CF00400#ABCD"))->bytes[0] == 0xAB);
  STATIC_REQUIRE(!message_from<Group>(frame("0CF00500#ABCD")));
  STATIC_REQUIRE(message_frame(Group{}) == frame("18F004FE#1234"));
}

}  // namespace protocol_message_test
