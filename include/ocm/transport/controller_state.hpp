/// How a CAN interface's controller is now, asked of the kernel over rtnetlink: its state and, where the
/// driver reads them, its error counters. Error frames say the same when it changes; this says it at any
/// time, to a program that came later, too. Needs no privileges. Host only.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <linux/can/netlink.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <optional>
#include <span>
#include <sys/socket.h>

#include "ocm/can/error_frame.hpp"
#include "ocm/host/descriptor.hpp"
#include "ocm/transport/interfaces.hpp"

namespace ocm::transport {

struct ControllerNow {
  can::ControllerState state = can::ControllerState::active;
  std::optional<can::ErrorCounters> counters{};  ///< none: its driver does not say
  friend bool operator==(const ControllerNow&, const ControllerNow&) = default;
};

namespace detail {

/// Of the kernel's state; nothing: it is stopped or asleep, and has none.
[[nodiscard]] constexpr std::optional<can::ControllerState> controller_state_of(
    std::uint32_t state) noexcept {
  switch (state) {
    case CAN_STATE_ERROR_ACTIVE:
      return can::ControllerState::active;
    case CAN_STATE_ERROR_WARNING:
      return can::ControllerState::warning;
    case CAN_STATE_ERROR_PASSIVE:
      return can::ControllerState::passive;
    case CAN_STATE_BUS_OFF:
      return can::ControllerState::bus_off;
    default:
      return std::nullopt;
  }
}

/// Of one datagram that answers RTM_GETLINK. Nothing where it is of no CAN interface, of one without a
/// controller, such as vcan, or broken.
[[nodiscard]] inline std::optional<ControllerNow> read_controller(
    std::span<const std::byte> datagram) noexcept {
  const auto header = read_object<nlmsghdr>(datagram);
  if (!header || header->nlmsg_len < sizeof *header || header->nlmsg_len > datagram.size())
    return std::nullopt;
  const auto message = datagram.subspan(sizeof *header, header->nlmsg_len - sizeof *header);
  const auto link = read_object<ifinfomsg>(message);
  if (header->nlmsg_type != RTM_NEWLINK || !link || link->ifi_type != can_hardware_type) return std::nullopt;
  const auto info = find_attribute(skip(message, sizeof *link), IFLA_LINKINFO);
  const auto data = find_attribute(info, IFLA_INFO_DATA);
  const auto number = read_object<std::uint32_t>(find_attribute(data, IFLA_CAN_STATE));
  const auto state = number ? controller_state_of(*number) : std::nullopt;
  if (!state) return std::nullopt;
  const auto counters = read_object<can_berr_counter>(find_attribute(data, IFLA_CAN_BERR_COUNTER));
  if (!counters) return ControllerNow{*state, std::nullopt};
  constexpr unsigned most = 255;  // an error frame has no room for more, either
  return ControllerNow{
      *state, can::ErrorCounters{static_cast<std::uint8_t>(std::min<unsigned>(counters->txerr, most)),
                                 static_cast<std::uint8_t>(std::min<unsigned>(counters->rxerr, most))}};
}

}  // namespace detail

/// Of the interface of that index (> 0), as the kernel numbers them; nothing where there is none, where it
/// has no controller (vcan), or where the kernel does not tell. About 20 us.
[[nodiscard]] inline std::optional<ControllerNow> query_controller(int index) {
  const host::Descriptor socket{::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE)};
  struct {
    nlmsghdr header{};
    ifinfomsg body{};
  } request;
  request.header.nlmsg_len = sizeof request;
  request.header.nlmsg_type = RTM_GETLINK;
  request.header.nlmsg_flags = NLM_F_REQUEST;
  request.body.ifi_index = index;
  if (!socket || ::send(socket.get(), &request, sizeof request, 0) < 0) return std::nullopt;
  alignas(nlmsghdr) std::array<std::byte, 32768> datagram;
  const ssize_t size = ::recv(socket.get(), datagram.data(), datagram.size(), 0);
  return size > 0 ? detail::read_controller(std::span{datagram}.first(static_cast<std::size_t>(size)))
                  : std::nullopt;
}

}  // namespace ocm::transport
