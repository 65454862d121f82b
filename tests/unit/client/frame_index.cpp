#include "ocm/client/frame_index.hpp"

#include <array>
#include <random>
#include <set>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include "unit/protocol/example_topics.hpp"

namespace client_frame_index_test {

using ocm::client::FrameIndex;
using ocm::protocol::Direction;
using ocm::protocol::Identifier;
using ocm::protocol::Priority;
using ocm::protocol::TopicId;
using ocm::test::catalogue;

const FrameIndex frame_index{catalogue};

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
  const FrameIndex empty;
  CHECK_FALSE(empty.find(sensor(0x10)));
  CHECK(empty.requested(to_board(0x10)) == nullptr);
  CHECK_FALSE(empty.subject(0x18FE'F100, ocm::can::Format::extended));
  CHECK_FALSE(empty.known(0x123, ocm::can::Format::base).accepts(1));
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

// Messages: an exact identifier of 11 and of 29 bits, and a parameter group of J1939.
constexpr ocm::protocol::FrameLayout layout_at(ocm::protocol::Address::By by, bool extended,
                                               std::uint32_t number) {
  ocm::protocol::FrameLayout layout;
  layout.length = 8;
  layout.address = {by, extended, number};
  return layout;
}
using By = ocm::protocol::Address::By;
constexpr std::array<ocm::protocol::FrameLayout, 5> layouts{
    layout_at(By::identifier, false, 0x123), layout_at(By::identifier, true, 0x123),
    layout_at(By::pgn, true, 0x0CF0'04FE), layout_at(By::identifier, true, 0x18F0'0417),
    layout_at(By::pgn, true, 0x18EF'12FE)};
constexpr std::array<std::string_view, 5> names{"short", "long", "group", "exact", "to_one"};
constexpr auto messages = [] {
  std::array<ocm::protocol::Topic, 5> all{};
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].name = names[i];
    all[i].kind = ocm::protocol::Kind::message;
    all[i].frames = {&layouts[i], 1};
  }
  return all;
}();

TEST_CASE("a message is known by its identifier and format, or by its group") {
  using ocm::can::Format;
  const FrameIndex index{ocm::protocol::Catalogue{"any", 500'000, {}, messages}};
  const auto name_of = [&](std::uint32_t id, Format format) -> std::string_view {
    const auto subject = index.subject(id, format);
    CHECK_FALSE(subject.is_request());
    return subject ? subject.topic->name : std::string_view{};
  };
  CHECK(name_of(0x123, Format::base) == "short");
  CHECK(name_of(0x123, Format::extended) == "long");
  CHECK(name_of(0x123, Format::base_remote).empty());
  CHECK(name_of(0x123, Format::error).empty());
  CHECK(name_of(0x0CF0'0400, Format::extended) == "group");  // another source
  CHECK(name_of(0x18F0'04FE, Format::extended) == "group");  // another priority
  CHECK(name_of(0x18F0'0417, Format::extended) == "exact");  // before its group
  CHECK(name_of(0x18F0'0500, Format::extended).empty());
  CHECK(name_of(0x0000'F004, Format::extended).empty());  // a group's number is no identifier
  CHECK(name_of(0x1000'F004, Format::extended).empty());
  CHECK(name_of(0x1CEF'9922, Format::extended) == "to_one");  // any destination
  CHECK_FALSE(index.find(Identifier::decode(0x123)));         // no frame of a topic
}

TEST_CASE("an index knows which lengths a frame may have, and whether it selects, as its layout does") {
  using ocm::can::Format;
  using ocm::protocol::Address;
  std::array<ocm::protocol::Field, 2> fields{};
  fields[1].selector = 0;
  std::array<ocm::protocol::FrameLayout, 4> frames{};
  std::array<ocm::protocol::Topic, 4> all{};
  for (std::size_t i = 0; i < all.size(); ++i) {
    frames[i].length = i == 2 ? 12 : 5;
    frames[i].address = {i == 2 ? Address::By::pgn : Address::By::identifier, i != 0,
                         static_cast<std::uint32_t>(i == 2 ? 0x18FE'F100 : 0x100 + i)};
    if (i == 3) frames[i].fields = fields;
    all[i].kind = ocm::protocol::Kind::message;
    all[i].frames = {&frames[i], 1};
  }
  const FrameIndex index{ocm::protocol::Catalogue{"any", 500'000, {}, all}};
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto known = index.known(frames[i].address.number, i == 0 ? Format::base : Format::extended);
    REQUIRE(known.topic == &all[i]);
    CHECK(known.selects == (i == 3));
    for (std::size_t bytes = 0; bytes <= 64; ++bytes)
      REQUIRE(known.accepts(bytes) == frames[i].accepts(bytes));
  }
  for (unsigned number = 0; number <= ocm::can::max_base_id; ++number) {
    const auto known = frame_index.known(number, Format::base);
    if (!known.frame()) continue;
    for (std::size_t bytes = 0; bytes <= 8; ++bytes)
      REQUIRE(known.accepts(bytes) == known.frame().layout().accepts(bytes));
  }
}

TEST_CASE("an interface has what is on it and what is on any, by its newest name") {
  using ocm::can::Format;
  std::array<ocm::protocol::FrameLayout, 3> on_buses{layout_at(By::identifier, false, 0x100),
                                                     layout_at(By::identifier, false, 0x100),
                                                     layout_at(By::identifier, false, 0x200)};
  std::array<ocm::protocol::Topic, 3> topics;
  constexpr std::array<std::string_view, 3> called{"car", "radar", "both"};
  constexpr std::array<std::string_view, 3> buses{"can0", "can1", ""};
  for (std::size_t i = 0; i < topics.size(); ++i) {
    topics[i].name = called[i];
    topics[i].bus = buses[i];
    topics[i].kind = ocm::protocol::Kind::message;
    topics[i].frames = {&on_buses[i], 1};
  }
  ocm::client::InterfaceIndexes indexes{ocm::protocol::Catalogue{"any", 500'000, {}, topics}};
  const auto name_of = [&](std::uint16_t interface, std::uint32_t id) -> std::string_view {
    const auto subject = indexes.of(interface).subject(id, Format::base);
    return subject ? subject.topic->name : std::string_view{};
  };
  REQUIRE(indexes.has_buses());
  indexes.name(0, "can0");
  indexes.name(3, "can1");
  indexes.name(4, "vcan0");
  CHECK(name_of(0, 0x100) == "car");
  CHECK(name_of(3, 0x100) == "radar");
  CHECK(name_of(4, 0x100).empty());
  for (const std::uint16_t interface : {std::uint16_t{0}, std::uint16_t{3}, std::uint16_t{4}})
    CHECK(name_of(interface, 0x200) == "both");
  CHECK(name_of(1, 0x100) == "car");  // without a name: all that there is
  CHECK(name_of(9, 0x200) == "both");
  indexes.name(0, "can1");  // another log has its own numbers
  CHECK(name_of(0, 0x100) == "radar");

  ocm::client::InterfaceIndexes same{catalogue};
  same.name(0, "can0");
  CHECK_FALSE(same.has_buses());
  CHECK(&same.of(0) == &same.of(7));
}

TEST_CASE("an index finds each of many messages, and none beside them") {
  std::vector<ocm::protocol::FrameLayout> many;
  for (std::uint32_t i = 0; i < 3000; ++i) many.push_back(layout_at(By::identifier, true, 7 * i));
  std::vector<ocm::protocol::Topic> topics(many.size());
  for (std::size_t i = 0; i < many.size(); ++i) {
    topics[i].kind = ocm::protocol::Kind::message;
    topics[i].frames = {&many[i], 1};
  }
  const FrameIndex index{ocm::protocol::Catalogue{"any", 500'000, {}, topics}};
  for (std::uint32_t id = 0; id < 7 * 3000; ++id) {
    const auto frame = index.subject(id, ocm::can::Format::extended).frame;
    REQUIRE(static_cast<bool>(frame) == (id % 7 == 0));
    if (frame) REQUIRE(frame.topic == &topics[id / 7]);
  }
}

TEST_CASE("an index finds messages whose places collide") {
  // Random identifiers: of those in a row, hashing makes too few that have to move on.
  std::mt19937 random{3};
  std::set<std::uint32_t> ids;
  while (ids.size() < 3000) ids.insert(random() & ocm::can::max_extended_id);
  std::vector<ocm::protocol::FrameLayout> many;
  for (const std::uint32_t id : ids) many.push_back(layout_at(By::identifier, true, id));
  std::vector<ocm::protocol::Topic> topics(many.size());
  for (std::size_t i = 0; i < many.size(); ++i) {
    topics[i].kind = ocm::protocol::Kind::message;
    topics[i].frames = {&many[i], 1};
  }
  const FrameIndex index{ocm::protocol::Catalogue{"any", 500'000, {}, topics}};
  for (const auto& topic : topics) {
    const std::uint32_t id = topic.frames[0].address.number;
    REQUIRE(index.subject(id, ocm::can::Format::extended).frame.topic == &topic);
    if (!ids.contains(id ^ 1U)) REQUIRE_FALSE(index.subject(id ^ 1U, ocm::can::Format::extended).frame);
  }
}

}  // namespace client_frame_index_test
