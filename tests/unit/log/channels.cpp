#include "ocm/log/channels.hpp"

#include <catch2/catch.hpp>

namespace log_channels_test {

using namespace ocm;
using namespace ocm::log;

TEST_CASE("channels: read as can-utils does") {
  Interfaces interfaces;
  ChannelsRead channels;
  CHECK(interfaces.name(channels.interface(2, interfaces)) == "can1");
  CHECK(interfaces.name(channels.interface(1, interfaces)) == "can0");
  CHECK(interfaces.name(channels.interface(0, interfaces)) == "canX");
  CHECK(interfaces.name(channels.interface(255, interfaces)) == "can254");
  CHECK(channels.interface(2, interfaces) == 0);
  CHECK(interfaces.size() == 4);
}

TEST_CASE("channels: names that a reader finds again keep their number, others take a free one") {
  Interfaces interfaces;
  for (const auto* name :
       {"can2", "vcan0", "can0", "can1", "can1", "can02", "can255", "canary", "can", "slcan0"})
    interfaces.add(name);
  ChannelsWritten channels;
  const auto numbered = [&](std::uint16_t interface) { return channels.of(interface, interfaces).number; };
  const auto named = [&](std::uint16_t interface) { return channels.of(interface, interfaces).names_it; };
  CHECK(numbered(3) == 4);  // those before it first: the order in which they are asked for does not count
  CHECK(numbered(0) == 3);
  CHECK(named(0));
  CHECK(numbered(1) == 1);
  CHECK_FALSE(named(1));
  CHECK(numbered(2) == 2);  // its own was taken
  CHECK_FALSE(named(2));
  for (std::uint16_t i = 3; i < interfaces.size(); ++i) CHECK_FALSE(named(i));
  CHECK(numbered(9) == 10);
}

TEST_CASE("channels: the last number that a name may have, and the first that it may not") {
  Interfaces interfaces;
  for (const auto* name : {"can254", "can0", "can255", "can00"}) interfaces.add(name);
  ChannelsWritten channels;
  CHECK(channels.of(0, interfaces).number == 255);
  CHECK(channels.of(0, interfaces).names_it);
  CHECK(channels.of(1, interfaces).number == 1);
  CHECK(channels.of(1, interfaces).names_it);
  CHECK(channels.of(2, interfaces).number == 2);
  CHECK_FALSE(channels.of(2, interfaces).names_it);
  CHECK(channels.of(3, interfaces).number == 3);
  CHECK_FALSE(channels.of(3, interfaces).names_it);
  ChannelsRead read;
  for (std::uint16_t i = 0; i < 2; ++i) {  // a reader finds those again
    const auto channel = channels.of(i, interfaces).number;
    CHECK(interfaces.name(read.interface(channel, interfaces)) == interfaces.name(i));
  }
}

TEST_CASE("channels: what is no name of a channel is not taken for the first one's") {
  for (const auto* name : {"can02", "canary", "can", "can255", "vcan0", ""}) {
    Interfaces interfaces;
    interfaces.add(name);
    ChannelsWritten channels;
    CAPTURE(name);
    CHECK(channels.of(0, interfaces).number == 1);
    CHECK_FALSE(channels.of(0, interfaces).names_it);
  }
}

TEST_CASE("channels: an error of which something is known") {
  const Entry plain{{}, {0x80, 8, {}, can::Format::error}};
  CHECK(is_bus_error(plain));
  CHECK_FALSE(is_bus_error(Entry{{}, {0x81, 8, {}, can::Format::error}}));
  CHECK_FALSE(is_bus_error(Entry{{}, {0x80, 7, {}, can::Format::error}}));
  for (std::size_t i = 0; i < 8; ++i) {
    Entry entry = plain;
    entry.data[i] = 1;
    CHECK_FALSE(is_bus_error(entry));
  }
}

TEST_CASE("channels: an error of which nothing is known") {
  Entry entry{{}, {0x123, 4, {1, 2, 3, 4}}, 3};
  entry.flags = flag::fd;
  entry.raw_dlc = 9;
  entry.direction = Direction::sent;
  CHECK_FALSE(is_bus_error(entry));
  set_bus_error(entry);
  CHECK(is_bus_error(entry));
  CHECK(entry.interface == 3);
  CHECK(entry == Entry{{}, {0x80, 8, {}, can::Format::error}, 3});  // asc2log: 20000080#0000000000000000
  entry.data[7] = 1;
  CHECK_FALSE(is_bus_error(entry));
}

}  // namespace log_channels_test
