#include "cli/shared/filters.hpp"

#include <array>
#include <vector>

#include <catch2/catch.hpp>

#include "unit/protocol/example_topics.hpp"

namespace filters_test {

using namespace ocm;
using namespace ocm::cli;
using can::Format;

bool passes_one(std::uint32_t id, Format format, const can_filter& filter) {
  return passes(id, format, std::array{filter});
}
can_filter filter(std::string_view text) {
  const auto parsed = parse_filter(text);
  CAPTURE(text);
  REQUIRE(parsed);
  return *parsed;
}

TEST_CASE("filters: as candump writes them") {
  CHECK(filter("123:7FF").can_id == 0x123);
  CHECK(filter("123:7FF").can_mask == 0x7FF);
  CHECK(filter("123~7FF").can_id == (0x123 | CAN_INV_FILTER));
  CHECK(filter("00000123:7FF").can_id == (0x123 | CAN_EFF_FLAG));  // eight digits
  CHECK(filter("0000123:7FF").can_id == 0x123);
  CHECK(filter("1FFFFFFF:FFFFFFFF").can_id == (0x1FFFFFFF | CAN_EFF_FLAG));
  CHECK(filter("1:FFFFFFFF").can_mask == (0xFFFFFFFF & ~CAN_ERR_FLAG));  // error frames are not chosen so
  for (const char* text :
       {"", ":", "123", "123:", ":7FF", "12x:7FF", "123:7Fx", "20000000:7FF", "123:100000000"}) {
    CAPTURE(text);
    CHECK_FALSE(parse_filter(text));
  }
}

TEST_CASE("filters: what passes") {
  CHECK(passes(0x123, Format::base, {}));
  CHECK(passes_one(0x123, Format::base, filter("123:7FF")));
  CHECK_FALSE(passes_one(0x124, Format::base, filter("123:7FF")));
  CHECK(passes_one(0x124, Format::base, filter("120:7F0")));
  CHECK_FALSE(passes_one(0x123, Format::base, filter("123~7FF")));
  CHECK(passes_one(0x124, Format::base, filter("123~7FF")));
  // The format counts where the mask asks for it.
  CHECK(passes_one(0x123, Format::extended, filter("123:7FF")));
  CHECK_FALSE(passes_one(0x123, Format::base, filter("00000123:9FFFFFFF")));
  CHECK(passes_one(0x123, Format::extended, filter("00000123:9FFFFFFF")));
  CHECK_FALSE(passes_one(0x123, Format::base_remote, {0x123, CAN_SFF_MASK | CAN_RTR_FLAG}));
  // Any of several; error frames whatever the filters are; no frame at all.
  const std::array two{filter("123:7FF"), filter("125:7FF")};
  CHECK(passes(0x125, Format::base, two));
  CHECK_FALSE(passes(0x124, Format::base, two));
  CHECK(passes(0x4, Format::error, two));
  CHECK_FALSE(passes_one(0x123, Format::base, no_frame));
}

TEST_CASE("filters: a parameter group is one from any sender, at any priority") {
  CHECK(passes_one(0x18FEF100, Format::extended, group_filter(0xFEF1)));
  CHECK(passes_one(0x0CFEF1A7, Format::extended, group_filter(0xFEF1)));
  CHECK_FALSE(passes_one(0x18FEF200, Format::extended, group_filter(0xFEF1)));
  CHECK(passes_one(0x18EF2A00, Format::extended, group_filter(0xEF00)));  // to one node: to any
  CHECK_FALSE(passes_one(0x123, Format::base, group_filter(0xFEF1)));
}

TEST_CASE("filters: of topics, and with commands") {
  const protocol::Topic* const scale = &test::catalogue.topics[0];
  const protocol::Topic* const lamp = &test::catalogue.topics[1];
  REQUIRE(scale->kind == protocol::Kind::sensor);
  REQUIRE(lamp->kind == protocol::Kind::actuator);
  const auto id = [](protocol::Direction direction, protocol::Priority priority, std::uint8_t topic) {
    return protocol::Identifier{direction, priority, protocol::TopicId{topic}}.encode();
  };
  using protocol::Direction;
  using protocol::Priority;
  const std::array of_scale{scale};
  const Filters data = filters_for(of_scale, false), all = filters_for(of_scale, true);
  for (const Priority priority : {Priority::urgent, Priority::low})
    for (const std::uint8_t topic : {std::uint8_t{0x10}, std::uint8_t{0x21}})
      CHECK(passes(id(Direction::sensor, priority, topic), Format::base, data));
  CHECK_FALSE(passes(id(Direction::sensor, Priority::low, 0x11), Format::base, data));
  CHECK_FALSE(passes(id(Direction::command, Priority::low, 0x10), Format::base, data));
  CHECK(passes(id(Direction::command, Priority::low, 0x10), Format::base, all));
  CHECK(passes(id(Direction::sensor, Priority::low, 0x10), Format::base, all));
  // An actuator's set points are what it is for.
  CHECK(passes(id(Direction::command, Priority::low, 0x30), Format::base,
               filters_for(std::array{lamp}, false)));
  CHECK_FALSE(
      passes(id(Direction::sensor, Priority::low, 0x30), Format::base, filters_for(std::array{lamp}, true)));
}

TEST_CASE("filters: of messages, by identifier or parameter group, with packets where one goes in them") {
  const auto message = [](protocol::FrameLayout& layout, protocol::Address address, std::uint16_t length) {
    layout.address = address;
    layout.length = length;
    protocol::Topic topic;
    topic.kind = protocol::Kind::message;
    topic.frames = {&layout, 1};
    return topic;
  };
  using By = protocol::Address::By;
  protocol::FrameLayout base, extended, group, in_packets;
  const protocol::Topic of_11_bits = message(base, {By::identifier, false, 0x123}, 64);
  const protocol::Topic of_29_bits = message(extended, {By::identifier, true, 0x123}, 8);
  const protocol::Topic in_one_frame = message(group, {By::pgn, true, 0x18FEF100}, 8);
  const protocol::Topic in_several = message(in_packets, {By::pgn, true, 0x18FEEC00}, 9);
  CHECK_FALSE(goes_in_packets(of_11_bits));
  CHECK_FALSE(goes_in_packets(in_one_frame));
  CHECK(goes_in_packets(in_several));
  CHECK_FALSE(goes_in_packets(test::catalogue.topics[0]));

  const Filters filters_11 = filters_for(std::array{&of_11_bits}, false);
  CHECK(passes(0x123, Format::base, filters_11));
  CHECK_FALSE(passes(0x124, Format::base, filters_11));
  CHECK_FALSE(passes(0x123, Format::extended, filters_11));
  CHECK_FALSE(passes(0x123, Format::base_remote, filters_11));
  CHECK(bus_filters(filters_11));
  const Filters filters_29 = filters_for(std::array{&of_29_bits}, true);
  CHECK(passes(0x123, Format::extended, filters_29));
  CHECK_FALSE(passes(0x123, Format::base, filters_29));
  CHECK_FALSE(passes(0x1000'0123, Format::extended, filters_29));

  // Packets of any message are in the groups EC00 and EB00. [SAE J1939-21, 5.10]
  constexpr std::uint32_t announcement = 0x1CECFF00, packet = 0x1CEBFF00;
  const Filters alone = filters_for(std::array{&in_one_frame}, false);
  CHECK(passes(0x18FEF12A, Format::extended, alone));
  CHECK_FALSE(passes(announcement, Format::extended, alone));
  CHECK_FALSE(passes(packet, Format::extended, alone));
  for (const auto& several :
       {std::array{&in_several, &in_one_frame}, std::array{&in_one_frame, &in_several}}) {
    const Filters with_packets = filters_for(several, false);
    CHECK(passes(0x18FEEC2A, Format::extended, with_packets));
    CHECK(passes(0x18FEF12A, Format::extended, with_packets));
    CHECK(passes(announcement, Format::extended, with_packets));
    CHECK(passes(packet, Format::extended, with_packets));
    CHECK_FALSE(passes(0x18FEF200, Format::extended, with_packets));
    CHECK_FALSE(passes(packet & CAN_SFF_MASK, Format::base, with_packets));
    CHECK_FALSE(bus_filters(with_packets));
  }
  CHECK(is_packet(announcement, Format::extended));
  CHECK_FALSE(is_packet(0x18FEF100, Format::extended));
  CHECK_FALSE(is_packet(0x700, Format::base));
  can::AnyFrame frame;
  frame.id = packet;
  frame.format = Format::extended;
  CHECK(is_packet(log::Entry{{}, frame}));
  frame.flags = can::fd_flags(true);  // CAN FD has no such protocol
  CHECK_FALSE(is_packet(log::Entry{{}, frame}));
}

TEST_CASE("filters: a bus that filters base frames only, or does not filter") {
  constexpr canid_t formats = CAN_EFF_FLAG | CAN_RTR_FLAG;
  const auto known =
      bus_filters(std::array{can_filter{0x123, CAN_SFF_MASK | formats}, can_filter{0x200, 0x700 | formats}});
  REQUIRE(known);
  REQUIRE(known->size() == 2);
  CHECK((*known)[1].id == 0x200);
  CHECK((*known)[1].mask == 0x700);
  CHECK_FALSE(bus_filters(std::array{can_filter{0x123, CAN_SFF_MASK}}));
  CHECK_FALSE(bus_filters(std::array{can_filter{0x123, CAN_SFF_MASK | CAN_EFF_FLAG}}));
  CHECK_FALSE(bus_filters(std::array{can_filter{0x123 | CAN_EFF_FLAG, CAN_EFF_MASK | formats}}));
  CHECK_FALSE(bus_filters(std::array{can_filter{0x123 | CAN_INV_FILTER, CAN_SFF_MASK | formats}}));
}

}  // namespace filters_test
