#include "ocm/protocol/message.hpp"

#include <catch2/catch.hpp>

#include "ocm/can/text.hpp"

#include "unit/protocol/example_topics.hpp"

namespace protocol_message_test {

using ocm::can::Frame;
using ocm::protocol::command;
using ocm::protocol::frame_id;
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

}  // namespace protocol_message_test
