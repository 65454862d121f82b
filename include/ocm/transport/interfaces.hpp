/// The CAN interfaces of this Linux machine, asked of the kernel over rtnetlink: which there are, which are
/// up, of what kind and at which bit rate. Needs no privileges. Host only.
#pragma once

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <linux/can.h>
#include <linux/can/netlink.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <sys/socket.h>
#include <vector>

#include "ocm/host/descriptor.hpp"
#include "ocm/host/failure.hpp"

namespace ocm::transport {

/// The hardware type of a CAN interface: ARPHRD_CAN, which not every C library names. [linux/if_arp.h]
inline constexpr unsigned can_hardware_type = 280;

struct CanInterface {
  std::string name;
  int index = 0;
  bool up = false;
  std::string kind;            ///< "can", "vcan", "vxcan", ...; empty when the driver does not say
  std::uint32_t bit_rate = 0;  ///< bit/s; 0: none set, or the interface has no bit rate
  bool bus_off = false;        ///< the controller has left the bus after too many errors
  std::uint64_t sent = 0;      ///< frames that left, of every program, since the interface was made; may wrap
  friend bool operator==(const CanInterface&, const CanInterface&) = default;
};

namespace detail {

template <class T>
[[nodiscard]] std::optional<T> read_object(std::span<const std::byte> bytes) noexcept {
  T object;
  if (bytes.size() < sizeof object) return std::nullopt;
  std::memcpy(&object, bytes.data(), sizeof object);
  return object;
}

/// Netlink pads headers, messages and attributes to multiples of four bytes.
[[nodiscard]] constexpr std::size_t netlink_aligned(std::size_t size) noexcept {
  return (size + 3) & ~std::size_t{3};
}
[[nodiscard]] inline std::span<const std::byte> skip(std::span<const std::byte> bytes,
                                                     std::size_t size) noexcept {
  return bytes.subspan(std::min(netlink_aligned(size), bytes.size()));
}

/// The payload of the first attribute of this type; empty when there is none or the list is broken.
[[nodiscard]] inline std::span<const std::byte> find_attribute(std::span<const std::byte> attributes,
                                                               unsigned type) noexcept {
  while (const auto header = read_object<rtattr>(attributes)) {
    if (header->rta_len < sizeof *header || header->rta_len > attributes.size()) break;
    if ((header->rta_type & NLA_TYPE_MASK) == type)
      return attributes.subspan(sizeof *header, header->rta_len - sizeof *header);
    attributes = skip(attributes, header->rta_len);
  }
  return {};
}

[[nodiscard]] inline std::string read_text(std::span<const std::byte> bytes) {
  std::string text(bytes.size(), '\0');
  if (!bytes.empty()) std::memcpy(text.data(), bytes.data(), bytes.size());
  text.resize(std::min(text.find('\0'), text.size()));
  return text;
}

/// How rtnl_link_stats64 begins, which newer kernels have made longer. [linux/if_link.h]
struct LinkStatistics {
  std::uint64_t received = 0;
  std::uint64_t transmitted = 0;
};

enum class LinkDump : std::uint8_t { more, done, failed };

/// Reads one datagram of the answer to RTM_GETLINK and adds the CAN interfaces in it.
[[nodiscard]] inline LinkDump read_links(std::span<const std::byte> datagram,
                                         std::vector<CanInterface>& interfaces) {
  while (const auto header = read_object<nlmsghdr>(datagram)) {
    if (header->nlmsg_len < sizeof *header || header->nlmsg_len > datagram.size()) return LinkDump::failed;
    const auto message = datagram.subspan(sizeof *header, header->nlmsg_len - sizeof *header);
    datagram = skip(datagram, header->nlmsg_len);
    if (header->nlmsg_type == NLMSG_DONE) return LinkDump::done;
    if (header->nlmsg_type == NLMSG_ERROR) return LinkDump::failed;
    const auto link = read_object<ifinfomsg>(message);
    if (header->nlmsg_type != RTM_NEWLINK || !link || link->ifi_type != can_hardware_type) continue;

    const auto attributes = skip(message, sizeof *link);
    const auto info = find_attribute(attributes, IFLA_LINKINFO);
    CanInterface interface;
    interface.name = read_text(find_attribute(attributes, IFLA_IFNAME));
    interface.index = link->ifi_index;
    interface.up = (link->ifi_flags & IFF_UP) != 0;
    interface.kind = read_text(find_attribute(info, IFLA_INFO_KIND));
    const auto timing =
        read_object<can_bittiming>(find_attribute(find_attribute(info, IFLA_INFO_DATA), IFLA_CAN_BITTIMING));
    if (interface.kind == "can" && timing) interface.bit_rate = timing->bitrate;
    const auto state =
        read_object<std::uint32_t>(find_attribute(find_attribute(info, IFLA_INFO_DATA), IFLA_CAN_STATE));
    interface.bus_off = interface.kind == "can" && state && *state == CAN_STATE_BUS_OFF;
    if (const auto statistics = read_object<LinkStatistics>(find_attribute(attributes, IFLA_STATS64)))
      interface.sent = statistics->transmitted;
    interfaces.push_back(std::move(interface));
  }
  return LinkDump::more;
}

[[nodiscard]] inline host::Failure interfaces_failure(int error) {
  return {std::string("cannot list the network interfaces (") + std::strerror(error) + ")",
          "if a sandbox forbids netlink sockets, run outside of it", host::Cause::interfaces_unknown};
}

}  // namespace detail

namespace detail {

/// All interfaces, or the one of this index.
[[nodiscard]] inline host::Outcome<std::vector<CanInterface>> query_links(int index) {
  const host::Descriptor socket{::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE)};
  if (!socket) return interfaces_failure(errno);
  struct {
    nlmsghdr header{};
    ifinfomsg body{};
  } request;
  request.header.nlmsg_len = sizeof request;
  request.header.nlmsg_type = RTM_GETLINK;
  request.header.nlmsg_flags =
      static_cast<std::uint16_t>(index == 0 ? NLM_F_REQUEST | NLM_F_DUMP : NLM_F_REQUEST);
  request.body.ifi_index = index;
  if (::send(socket.get(), &request, sizeof request, 0) < 0) return interfaces_failure(errno);

  std::vector<CanInterface> interfaces;
  alignas(nlmsghdr) std::array<std::byte, 65536> datagram;  // the kernel dumps at most 32 KiB at a time
  for (;;) {
    const ssize_t size = ::recv(socket.get(), datagram.data(), datagram.size(), 0);
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) return interfaces_failure(size < 0 ? errno : EPROTO);
    switch (read_links(std::span{datagram}.first(static_cast<std::size_t>(size)), interfaces)) {
      case LinkDump::more:
        if (index == 0) break;
        [[fallthrough]];
      case LinkDump::done:
        return interfaces;
      case LinkDump::failed:
        return interfaces_failure(EPROTO);
    }
  }
}

}  // namespace detail

/// Every CAN interface of the machine, up or down, in the kernel's order. Empty when there is none, which is
/// also the answer of a kernel without CAN: `can_support` tells these apart. About 50 us and 64 KiB of stack.
[[nodiscard]] inline host::Outcome<std::vector<CanInterface>> query_can_interfaces() {
  return detail::query_links(0);
}

/// The one of that index (> 0), as it is now; nothing when it is gone or the kernel would not tell. About 20
/// us.
[[nodiscard]] inline std::optional<CanInterface> query_can_interface(int index) {
  const auto found = detail::query_links(index);
  if (!found || found->size() != 1) return std::nullopt;
  return found->front();
}

/// As `query_can_interfaces`; also empty when the kernel would not tell.
[[nodiscard]] inline std::vector<CanInterface> can_interfaces() {
  return query_can_interfaces().value;
}

/// Why a CAN_RAW socket cannot be had, from the errno of socket(2).
[[nodiscard]] inline host::Failure can_socket_failure(int error) {
  const std::string reason = std::string(" (") + std::strerror(error) + ")";
  switch (error) {
    case EAFNOSUPPORT:
      return {"this kernel has no CAN" + reason, "sudo modprobe can_raw", host::Cause::can_missing};
    case EPROTONOSUPPORT:
      return {"this kernel has CAN, but no raw sockets" + reason, "sudo modprobe can_raw",
              host::Cause::can_missing};
    case EPERM:
    case EACCES:
      return {"not allowed to open a CAN socket" + reason,
              "a sandbox or container forbids it: run outside of it, or allow AF_CAN sockets there"};
    default:
      return {"cannot open a CAN socket" + reason,
              "close other programs, or ask this machine's administrator"};
  }
}

/// Whether this process can have CAN sockets at all, by opening one. May make the kernel load its CAN
/// modules.
[[nodiscard]] inline host::Outcome<void> can_support() {
  const host::Descriptor socket{::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW)};
  if (!socket) return can_socket_failure(errno);
  return {};
}

}  // namespace ocm::transport
