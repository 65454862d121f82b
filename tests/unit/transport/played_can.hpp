/// One CAN interface, can7, and the socket on it, of a kernel that is played.
#pragma once

#include <deque>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <linux/sock_diag.h>
#include <map>
#include <memory>
#include <optional>
#include <sys/eventfd.h>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/can/any_text.hpp"
#include "ocm/transport/socketcan.hpp"

#include "unit/transport/netlink_answer.hpp"
#include "unit/transport/played_kernel.hpp"

namespace ocm::test {

using Bytes = std::vector<std::byte>;

/// What recvmmsg hands over: a frame and what comes with it.
struct Arrival {
  Bytes frame;
  std::optional<base::Time> stamp{};
  std::optional<std::uint32_t> drops{};
  int stamp_level = SOL_SOCKET;
};

struct PlayedCan {
  PlayedCan() {
    kernel.socket = [this](int family, int type, int protocol) {
      if (socket_error != 0 && family == PF_CAN) return failed(socket_error);
      const int file = ::eventfd(0, EFD_CLOEXEC);
      kernel.files.push_back(file);
      if (family == PF_CAN) {
        socket = file;
        socket_type = type;
        socket_protocol = protocol;
      }
      return file;
    };
    kernel.bind = [this](int, const sockaddr* wanted) {
      std::memcpy(&address, wanted, sizeof address);
      return bind_error == 0 ? 0 : failed(bind_error);
    };
    kernel.setsockopt = [this](int, int level, int name, const void* value, socklen_t size) {
      if (const auto error = option_errors.find({level, name}); error != option_errors.end())
        return failed(error->second);
      const auto* const begin = static_cast<const std::byte*>(value);
      options[{level, name}] = Bytes(begin, begin + size);
      return 0;
    };
    kernel.getsockopt = [this](int, int level, int name, void* value, socklen_t* size) {
      if (level != SOL_SOCKET || name != SO_MEMINFO || memory_variables == 0) return failed(ENOPROTOOPT);
      auto* const variables = static_cast<std::uint32_t*>(value);
      for (unsigned i = 0; i < SK_MEMINFO_VARS; ++i) variables[i] = 1000 + i;
      variables[SK_MEMINFO_DROPS] = drops;
      *size = static_cast<socklen_t>(memory_variables * sizeof(std::uint32_t));
      return 0;
    };
    kernel.ioctl = [this](int, unsigned long request, void* argument) {
      return control(request, *static_cast<ifreq*>(argument));
    };
    kernel.send = [this](int file, const void* bytes, std::size_t size, int) -> ssize_t {
      const auto* const begin = static_cast<const std::byte*>(bytes);
      if (file != socket) {
        asked_links.emplace_back(begin, begin + size);
        return static_cast<ssize_t>(size);
      }
      ++asked;
      const int error = answers.empty() ? 0 : answers.front();
      if (!answers.empty()) answers.pop_front();
      if (error != 0) return failed(error);
      taken.emplace_back(begin, begin + size);
      return static_cast<ssize_t>(size);
    };
    kernel.recv = [this](int, void* bytes, std::size_t) -> ssize_t {
      const auto none = netlink::bytes_of(0);
      using netlink::operator+;
      const Bytes answer = link ? netlink::link(*link) + netlink::message(NLMSG_DONE, none)
                                : netlink::message(NLMSG_ERROR, none);
      std::copy(answer.begin(), answer.end(), static_cast<std::byte*>(bytes));
      return static_cast<ssize_t>(answer.size());
    };
    kernel.recvmmsg = [this](int, mmsghdr* messages, unsigned count) { return hand_on(messages, count); };
    kernel.ready = [this](short) {
      return !queue.empty() || !errors.empty() || std::exchange(wake, false) ? POLLIN : short{0};
    };
  }
  PlayedCan(const PlayedCan&) = delete;
  PlayedCan& operator=(const PlayedCan&) = delete;

  int control(unsigned long request, ifreq& asked_of) {
    if (const auto error = control_errors.find(request); error != control_errors.end())
      return failed(error->second);
    if (request == SIOCGIFINDEX) {
      if (std::string_view{asked_of.ifr_name} != "can7") return failed(ENODEV);
      asked_of.ifr_ifindex = 7;
      return 0;
    }
    if (request == SIOCGIFNAME) {
      if (gone || asked_of.ifr_ifindex != 7) return failed(ENODEV);
      std::strcpy(asked_of.ifr_name, "renamed");  // the index is what stays
      return 0;
    }
    const std::string_view name = asked_of.ifr_name;
    if (name != "can7" && name != "renamed") return failed(ENODEV);
    if (request == SIOCGIFHWADDR) asked_of.ifr_hwaddr.sa_family = hardware;
    if (request == SIOCGIFFLAGS) asked_of.ifr_flags = flags;
    if (request == SIOCGIFMTU) asked_of.ifr_mtu = mtu;
    return 0;
  }

  /// As the kernel: an error comes once, and before what waits.
  int hand_on(mmsghdr* messages, unsigned count) {
    ++reads;
    if (!errors.empty()) {
      const int error = errors.front();
      errors.pop_front();
      return failed(error);
    }
    if (queue.empty()) return failed(EAGAIN);
    unsigned filled = 0;
    for (; filled < count && !queue.empty(); ++filled) {
      const Arrival& arrival = queue.front();
      msghdr& header = messages[filled].msg_hdr;
      if (header.msg_iovlen != 1) return failed(EMSGSIZE);
      std::memcpy(header.msg_iov[0].iov_base, arrival.frame.data(),
                  std::min(header.msg_iov[0].iov_len, arrival.frame.size()));
      messages[filled].msg_len = static_cast<unsigned>(arrival.frame.size());
      std::size_t used = 0;
      const auto add = [&](int level, int type, const auto& content) {
        if (used + CMSG_SPACE(sizeof content) > header.msg_controllen) return;
        auto* const item = reinterpret_cast<cmsghdr*>(static_cast<std::byte*>(header.msg_control) + used);
        item->cmsg_level = level;
        item->cmsg_type = type;
        item->cmsg_len = CMSG_LEN(sizeof content);
        std::memcpy(CMSG_DATA(item), &content, sizeof content);
        used += CMSG_SPACE(sizeof content);
      };
      if (arrival.stamp) {
        const std::int64_t ns = arrival.stamp->time_since_epoch().count();
        add(arrival.stamp_level, SO_TIMESTAMPNS,
            timespec{static_cast<time_t>(ns / 1'000'000'000), static_cast<long>(ns % 1'000'000'000)});
      }
      if (arrival.drops) add(SOL_SOCKET, SO_RXQ_OVFL, *arrival.drops);
      header.msg_controllen = used;
      queue.pop_front();
    }
    return static_cast<int>(filled);
  }

  void arrive(const char* text, base::Time stamp, std::optional<std::uint32_t> drops_then = {}) {
    const auto frame = *can::parse_any_frame(text);
    const auto classic = frame.classic();
    queue.push_back({classic ? netlink::bytes_of(transport::to_socketcan(*classic))
                             : netlink::bytes_of(transport::to_socketcan_fd(frame)),
                     stamp, drops_then});
  }

  std::unique_ptr<transport::SocketCan> open() {
    auto opened = transport::SocketCan::open("can7");
    INFO(opened.error.what);
    REQUIRE(opened);
    return std::move(opened.value);
  }

  PlayedKernel kernel;
  int socket_error = 0;
  int bind_error = 0;
  std::map<std::pair<int, int>, int> option_errors;  ///< by level and name
  std::map<unsigned long, int> control_errors;       ///< of ioctl, by request
  unsigned short hardware = transport::can_hardware_type;
  short flags = IFF_UP;
  int mtu = CANFD_MTU;
  bool gone = false;
  std::optional<transport::CanInterface> link =
      transport::CanInterface{.name = "can7", .index = 7, .up = true, .kind = "can", .bit_rate = 500'000};

  int socket = -1;
  int socket_type = 0;
  int socket_protocol = 0;
  sockaddr_can address{};
  std::map<std::pair<int, int>, Bytes> options;
  std::vector<Bytes> asked_links;

  std::deque<int> answers;  ///< of the next sends: 0 or errno
  std::vector<Bytes> taken;
  int asked = 0;

  std::deque<Arrival> queue;
  std::deque<int> errors;  ///< of the next reads
  int reads = 0;
  bool wake = false;  ///< poll says once that there is something, and there is nothing
  std::uint32_t drops = 0;
  unsigned memory_variables = SK_MEMINFO_VARS;
};

}  // namespace ocm::test
