#include "ocm/transport/interfaces.hpp"

#include <catch2/catch.hpp>

#include "unit/transport/netlink_answer.hpp"

namespace transport_interfaces_test {

using namespace ocm;
using transport::CanInterface;
using transport::detail::LinkDump;

using namespace test::netlink;

Bytes link(unsigned hardware, int index, unsigned flags, const Bytes& attributes,
           unsigned type = RTM_NEWLINK) {
  ifinfomsg body{};
  body.ifi_type = static_cast<unsigned short>(hardware);
  body.ifi_index = index;
  body.ifi_flags = flags;
  return message(type, bytes_of(body) + attributes);
}

Bytes can_info(std::uint32_t bit_rate, std::uint32_t state = CAN_STATE_ERROR_ACTIVE) {
  can_bittiming timing{};
  timing.bitrate = bit_rate;
  return attribute(IFLA_LINKINFO | NLA_F_NESTED,
                   attribute(IFLA_INFO_KIND, text("can")) +
                       attribute(IFLA_INFO_DATA, attribute(IFLA_CAN_BITTIMING, bytes_of(timing)) +
                                                     attribute(IFLA_CAN_STATE, bytes_of(state))));
}

TEST_CASE("only the CAN interfaces are read from the kernel's list") {
  std::vector<CanInterface> found;
  const Bytes datagram =
      link(ARPHRD_LOOPBACK, 1, IFF_UP, attribute(IFLA_IFNAME, text("lo"))) +
      link(transport::can_hardware_type, 4, IFF_UP | IFF_RUNNING,
           attribute(IFLA_IFNAME, text("can0")) + can_info(500'000)) +
      link(transport::can_hardware_type, 5, 0,
           attribute(IFLA_IFNAME, text("vcan12")) +
               attribute(IFLA_LINKINFO, attribute(IFLA_INFO_KIND, text("vcan")))) +
      link(transport::can_hardware_type, 6, IFF_UP, attribute(IFLA_IFNAME, text("gone")), RTM_DELLINK) +
      message(RTM_NEWLINK, bytes_of(std::uint32_t{0}));  // too short to say what it is
  CHECK(transport::detail::read_links(datagram, found) == LinkDump::more);
  REQUIRE(found.size() == 2);
  CHECK(found[0] == CanInterface{"can0", 4, true, "can", 500'000});
  CHECK(found[1] == CanInterface{"vcan12", 5, false, "vcan", 0});
  CHECK(transport::detail::read_links(message(NLMSG_DONE, bytes_of(0)), found) == LinkDump::done);
  CHECK(transport::detail::read_links(message(NLMSG_ERROR, bytes_of(-1)), found) == LinkDump::failed);
  CHECK(found.size() == 2);
}

TEST_CASE("a broken answer about interfaces is refused at every length") {
  const Bytes whole =
      link(transport::can_hardware_type, 4, IFF_UP, attribute(IFLA_IFNAME, text("can0")) + can_info(500'000));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    std::vector<CanInterface> found;
    // Less than a header is no message; more is one that claims to be longer than it is.
    CHECK(transport::detail::read_links(cut, found) ==
          (size < sizeof(nlmsghdr) ? LinkDump::more : LinkDump::failed));
    CHECK(found.empty());
  }
  nlmsghdr endless{};  // a length of zero would never advance
  std::vector<CanInterface> found;
  CHECK(transport::detail::read_links(bytes_of(endless), found) == LinkDump::failed);
  rtattr too_short{};
  too_short.rta_len = 3;
  CHECK(transport::detail::find_attribute(bytes_of(too_short), 0).empty());
}

TEST_CASE("a controller that is bus-off, and what an interface has sent") {
  std::vector<CanInterface> found;
  rtnl_link_stats64 statistics{};
  statistics.rx_packets = 7;
  statistics.tx_packets = 41;
  for (const auto& [state, off] : {std::pair{CAN_STATE_BUS_OFF, true},
                                   {CAN_STATE_ERROR_PASSIVE, false},
                                   {CAN_STATE_ERROR_ACTIVE, false}}) {
    found.clear();
    const Bytes one =
        link(transport::can_hardware_type, 4, IFF_UP,
             attribute(IFLA_IFNAME, text("can0")) + attribute(IFLA_STATS64, bytes_of(statistics)) +
                 can_info(500'000, static_cast<std::uint32_t>(state)));
    CHECK(transport::detail::read_links(one, found) == LinkDump::more);
    REQUIRE(found.size() == 1);
    CHECK(found[0].bus_off == off);
    CHECK(found[0].sent == 41);
  }
}

TEST_CASE("a bit rate and a state are those of a controller, and only where the kernel says them") {
  const auto read = [](const Bytes& attributes) {
    std::vector<CanInterface> found;
    CHECK(transport::detail::read_links(
              link(transport::can_hardware_type, 9, IFF_UP,
                   attribute(IFLA_IFNAME, text("x")) + attribute(IFLA_LINKINFO, attributes)),
              found) == LinkDump::more);
    REQUIRE(found.size() == 1);
    return found[0];
  };
  can_bittiming timing{};
  timing.bitrate = 250'000;
  const Bytes data =
      attribute(IFLA_INFO_DATA, attribute(IFLA_CAN_BITTIMING, bytes_of(timing)) +
                                    attribute(IFLA_CAN_STATE, bytes_of(std::uint32_t{CAN_STATE_BUS_OFF})));
  CHECK(read(attribute(IFLA_INFO_KIND, text("can")) + data) ==
        CanInterface{"x", 9, true, "can", 250'000, true, 0});
  CHECK(read(attribute(IFLA_INFO_KIND, text("vxcan")) + data) ==
        CanInterface{"x", 9, true, "vxcan", 0, false, 0});
  CHECK(read(attribute(IFLA_INFO_KIND, text("can"))) == CanInterface{"x", 9, true, "can", 0, false, 0});
  CHECK(read({}) == CanInterface{"x", 9, true, "", 0, false, 0});
  // A name without its zero, and the first of two attributes.
  CHECK(transport::detail::read_text(Bytes{std::byte{'a'}, std::byte{'b'}}) == "ab");
  CHECK(transport::detail::read_text({}).empty());
  const Bytes two = attribute(7, text("one")) + attribute(7, text("two")) + attribute(8, text("three"));
  CHECK(transport::detail::read_text(transport::detail::find_attribute(two, 7)) == "one");
  CHECK(transport::detail::read_text(transport::detail::find_attribute(two, 8)) == "three");
  CHECK(transport::detail::find_attribute(two, 9).empty());
  CHECK(transport::detail::find_attribute(attribute(8, {}), 8).empty());
}

TEST_CASE("a message without a content, and an attribute without one, are whole") {
  std::vector<CanInterface> found;
  CHECK(transport::detail::read_links(message(NLMSG_DONE, {}), found) == LinkDump::done);
  CHECK(transport::detail::read_links(message(NLMSG_NOOP, {}) + message(NLMSG_DONE, {}), found) ==
        LinkDump::done);
  const Bytes behind = attribute(7, {}) + attribute(8, text("eight"));
  CHECK(transport::detail::read_text(transport::detail::find_attribute(behind, 8)) == "eight");
}

TEST_CASE("the kernel answers, with or without CAN") {
  const auto found = transport::query_can_interfaces();
  REQUIRE(found);
  const auto again = transport::can_interfaces();
  REQUIRE(again.size() == found->size());
  for (std::size_t i = 0; i < again.size(); ++i) CHECK(again[i].name == (*found)[i].name);
  CHECK_FALSE(transport::query_can_interface(INT32_MAX));
  // A machine without CAN has a loopback interface, which is none.
  const unsigned loopback = if_nametoindex("lo");
  REQUIRE(loopback != 0);
  CHECK_FALSE(transport::query_can_interface(static_cast<int>(loopback)));
  for (const CanInterface& interface : *found) CHECK(interface.name != "lo");
  for (const CanInterface& interface : *found) {
    CHECK_FALSE(interface.name.empty());
    CHECK(interface.index > 0);
  }
  if (const auto support = transport::can_support(); !support) {
    CHECK(found->empty());
    CHECK_FALSE(support.error.remedy.empty());
  }
}

TEST_CASE("why a CAN socket cannot be had") {
  using transport::can_socket_failure;
  CHECK_THAT(can_socket_failure(EAFNOSUPPORT).what, Catch::StartsWith("this kernel has no CAN"));
  CHECK(can_socket_failure(EAFNOSUPPORT).remedy == "sudo modprobe can_raw");
  CHECK(can_socket_failure(EAFNOSUPPORT).cause == host::Cause::can_missing);
  CHECK(can_socket_failure(EPERM).cause == host::Cause::other);
  CHECK_THAT(can_socket_failure(EPROTONOSUPPORT).what, Catch::Contains("no raw sockets"));
  CHECK_THAT(can_socket_failure(EPERM).what, Catch::StartsWith("not allowed"));
  CHECK_THAT(can_socket_failure(EMFILE).what, Catch::Contains(std::strerror(EMFILE)));
}

}  // namespace transport_interfaces_test
