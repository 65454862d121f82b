/// What the kernel answers over rtnetlink when it is asked for a CAN interface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/transport/interfaces.hpp"

namespace ocm::test::netlink {

using Bytes = std::vector<std::byte>;

template <class T>
Bytes bytes_of(const T& object) {
  const auto* begin = reinterpret_cast<const std::byte*>(&object);
  return {begin, begin + sizeof object};
}
inline Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}
inline Bytes padded(Bytes bytes) {
  bytes.resize((bytes.size() + 3) & ~std::size_t{3});
  return bytes;
}
inline Bytes attribute(unsigned type, const Bytes& payload) {
  rtattr header{};
  header.rta_len = static_cast<unsigned short>(sizeof header + payload.size());
  header.rta_type = static_cast<unsigned short>(type);
  return padded(bytes_of(header) + payload);
}
inline Bytes text(std::string_view words) {
  Bytes bytes;
  for (const char c : words) bytes.push_back(static_cast<std::byte>(c));
  bytes.push_back(std::byte{0});
  return bytes;
}
inline Bytes message(unsigned type, const Bytes& payload) {
  nlmsghdr header{};
  header.nlmsg_len = static_cast<unsigned>(sizeof header + payload.size());
  header.nlmsg_type = static_cast<unsigned short>(type);
  return padded(bytes_of(header) + payload);
}

/// One interface with a controller.
inline Bytes link(const transport::CanInterface& interface, std::uint32_t state = CAN_STATE_ERROR_ACTIVE) {
  ifinfomsg body{};
  body.ifi_type = static_cast<unsigned short>(transport::can_hardware_type);
  body.ifi_index = interface.index;
  body.ifi_flags = interface.up ? unsigned{IFF_UP} : 0U;
  rtnl_link_stats64 statistics{};
  statistics.tx_packets = interface.sent;
  can_bittiming timing{};
  timing.bitrate = interface.bit_rate;
  if (interface.bus_off) state = CAN_STATE_BUS_OFF;
  return message(RTM_NEWLINK,
                 bytes_of(body) + attribute(IFLA_IFNAME, text(interface.name)) +
                     attribute(IFLA_STATS64, bytes_of(statistics)) +
                     attribute(IFLA_LINKINFO, attribute(IFLA_INFO_KIND, text(interface.kind)) +
                                                  attribute(IFLA_INFO_DATA,
                                                            attribute(IFLA_CAN_BITTIMING, bytes_of(timing)) +
                                                                attribute(IFLA_CAN_STATE, bytes_of(state)))));
}

}  // namespace ocm::test::netlink
