#include "ocm/protocol/identifier.hpp"

#include <set>
#include <type_traits>

#include <catch2/catch.hpp>

namespace protocol_identifier_test {

using ocm::base::Error;
using ocm::protocol::Direction;
using ocm::protocol::Identifier;
using ocm::protocol::parse_priority;
using ocm::protocol::Priority;
using ocm::protocol::TopicId;

// id = c_s << 10 | priority << 8 | topic. [Thesis 4.1, figure 4.1]
static_assert(Identifier{Direction::command, Priority::medium, TopicId{0x05}}.encode() == 0x205);
static_assert(Identifier{Direction::sensor, Priority::medium, TopicId{0x05}}.encode() == 0x605);
static_assert(Identifier{Direction::command, Priority::urgent, TopicId{0x01}}.encode() == 0x001);
static_assert(Identifier{Direction::command, Priority::high, TopicId{0x08}}.encode() == 0x108);
static_assert(Identifier{Direction::sensor, Priority::low, TopicId{0xFF}}.encode() == 0x7FF);
static_assert(Identifier::decode(0x608) == Identifier{Direction::sensor, Priority::medium, TopicId{0x08}});
// Medium is the default. [Thesis 4.2]
static_assert(Identifier{Direction::command, Priority::urgent, TopicId{0xFF}}.encode() ==
              (0x3FF & ocm::protocol::topic_mask));
static_assert((Identifier{Direction::sensor, Priority::low, TopicId{0xFF}}.encode() &
               ocm::protocol::topic_mask) == 0x4FF);
static_assert(Identifier{}.priority == Priority::medium);
static_assert(ocm::protocol::default_priority == Priority::medium);

TEST_CASE("every identifier of 11 bits has one meaning, and every meaning one identifier") {
  std::set<std::uint32_t> seen;
  for (unsigned direction = 0; direction < 2; ++direction)
    for (unsigned priority = 0; priority < ocm::protocol::priority_levels; ++priority)
      for (unsigned topic = 0; topic < 256; ++topic) {
        const Identifier id{static_cast<Direction>(direction), static_cast<Priority>(priority),
                            TopicId{static_cast<std::uint8_t>(topic)}};
        REQUIRE(id.encode() == direction * 1024 + priority * 256 + topic);
        REQUIRE(Identifier::decode(id.encode()) == id);
        seen.insert(id.encode());
      }
  CHECK(seen.size() == 2048);
  CHECK(*seen.rbegin() == ocm::can::max_base_id);
}

TEST_CASE("bits beyond the eleventh are cut off") {
  STATIC_REQUIRE(Identifier::decode(0xFFFF'FA05) == Identifier::decode(0x205));
}

TEST_CASE("lower identifiers win: commands before sensors, urgent before low, then low topics") {
  constexpr auto number = [](Direction d, Priority p, std::uint8_t t) {
    return Identifier{d, p, TopicId{t}}.encode();
  };
  STATIC_REQUIRE(number(Direction::command, Priority::low, 255) <
                 number(Direction::sensor, Priority::urgent, 0));
  STATIC_REQUIRE(number(Direction::sensor, Priority::urgent, 255) <
                 number(Direction::sensor, Priority::high, 0));
  STATIC_REQUIRE(number(Direction::sensor, Priority::medium, 4) <
                 number(Direction::sensor, Priority::medium, 5));
}

TEST_CASE("a priority's word reads back as the priority") {
  for (const auto priority : {Priority::urgent, Priority::high, Priority::medium, Priority::low})
    CHECK(parse_priority(name(priority)) == priority);
  STATIC_REQUIRE(name(Priority::urgent) == "urgent");
  STATIC_REQUIRE(name(Priority::low) == "low");
  for (const auto bad : {"", "Urgent", "urgen", "urgent ", "0", "normal"})
    CHECK(parse_priority(bad).error == Error::bad_syntax);
}

TEST_CASE("a topic's number is a type of its own") {
  STATIC_REQUIRE_FALSE(std::is_convertible_v<std::uint8_t, TopicId>);
  STATIC_REQUIRE_FALSE(std::is_convertible_v<TopicId, std::uint8_t>);
  STATIC_REQUIRE(TopicId{3} < TopicId{4});
  STATIC_REQUIRE(TopicId{}.value == 0);
}

}  // namespace protocol_identifier_test
