#include "cli/record/can_capture.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <linux/can/raw.h>
#include <linux/sock_diag.h>
#include <net/if.h>
#include <sys/ioctl.h>

#include "ocm/transport/interfaces.hpp"

namespace ocm::cli::record {
namespace {

using transport::BusState;

log::Entry to_entry(const canfd_frame& raw, bool fd) noexcept {
  log::Entry entry;
  const bool extended = (raw.can_id & CAN_EFF_FLAG) != 0;
  entry.id = raw.can_id & (extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  entry.format = extended ? can::Format::extended : can::Format::base;
  if ((raw.can_id & CAN_ERR_FLAG) != 0) {
    entry.format = can::Format::error;
    entry.id = raw.can_id & CAN_ERR_MASK;
  } else if ((raw.can_id & CAN_RTR_FLAG) != 0) {
    entry.format = extended ? can::Format::extended_remote : can::Format::base_remote;
  }
  const auto most = fd ? log::max_fd_length : can::max_dlc;
  entry.length = std::min(raw.len, most);
  if (fd) {
    entry.flags = static_cast<std::uint8_t>((raw.flags & (CANFD_BRS | CANFD_ESI)) | log::flag::fd);
  } else if (raw.len == can::max_dlc && raw.__res1 > can::max_dlc && raw.__res1 <= 15 &&
             entry.format != can::Format::error) {
    entry.raw_dlc = raw.__res1;  // where a classic frame has its len8_dlc
  }
  const auto bytes = entry.bytes();
  std::copy_n(std::begin(raw.data), bytes.size(), entry.data.begin());
  return entry;
}

base::Time to_time(const timespec& time) noexcept {
  return base::Time{std::chrono::seconds{time.tv_sec} + std::chrono::nanoseconds{time.tv_nsec}};
}

/// 0 or errno. The order matters: nothing may come before the filters stand.
int prepare(int socket, const Filters& filters, int index) noexcept {
  const auto set = [socket](int level, int name, const auto& value) {
    return ::setsockopt(socket, level, name, &value, sizeof value) == 0;
  };
  const can_err_mask_t all_errors = CAN_ERR_MASK;
  const int on = 1;
  const int buffer = transport::SocketCanOptions{}.receive_buffer_bytes;
  if (!set(SOL_CAN_RAW, CAN_RAW_ERR_FILTER, all_errors) || !set(SOL_CAN_RAW, CAN_RAW_FD_FRAMES, on) ||
      !set(SOL_SOCKET, SO_TIMESTAMPNS, on) || !set(SOL_SOCKET, SO_RXQ_OVFL, on))
    return errno;
  if (!set(SOL_SOCKET, SO_RCVBUFFORCE, buffer) && !set(SOL_SOCKET, SO_RCVBUF, buffer)) return errno;
  if (!filters.empty() && ::setsockopt(socket, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(),
                                       static_cast<socklen_t>(filters.size() * sizeof filters.front())) < 0)
    return errno;
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = index;
  return ::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) < 0 ? errno : 0;
}

}  // namespace

CanCapture::CanCapture(std::string_view name) : name_(name) {
  for (std::size_t i = 0; i < batch; ++i) {
    slots_[i].place = {&slots_[i].frame, sizeof slots_[i].frame};
    messages_[i].msg_hdr.msg_iov = &slots_[i].place;
    messages_[i].msg_hdr.msg_iovlen = 1;
    messages_[i].msg_hdr.msg_control = slots_[i].control.data();
  }
}

transport::Outcome<std::unique_ptr<Capture>> CanCapture::open(std::string_view name, const Filters& filters) {
  // Opened and closed: it knows in words all that can be wrong with an interface.
  if (auto checked = transport::SocketCan::open(name); !checked) return std::move(checked.error);
  std::unique_ptr<CanCapture> capture{new CanCapture(name)};
  for (const auto& interface : transport::can_interfaces())
    if (interface.name == name) {
      capture->index_ = interface.index;
      capture->bit_rate_ = interface.bit_rate;
    }
  capture->socket_ = host::Descriptor{::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_RAW)};
  if (!capture->socket_) return transport::can_socket_failure(errno);
  if (capture->index_ == 0) return transport::detail::gone_failure(name);  // 0 would be all interfaces
  if (const int error = prepare(capture->socket_.get(), filters, capture->index_); error != 0)
    return transport::detail::system_failure(name, "record", error);
  return std::unique_ptr<Capture>{std::move(capture)};
}

std::unique_ptr<CanCapture> CanCapture::of(host::Descriptor socket, std::string_view name, int index) {
  std::unique_ptr<CanCapture> capture{new CanCapture(name)};
  capture->socket_ = std::move(socket);
  capture->index_ = index;
  return capture;
}

std::size_t CanCapture::read(std::span<log::Entry> into, std::uint16_t interface) {
  if (state_ == BusState::closed) return 0;
  const int count = receive(std::min(into.size(), batch));
  if (count <= 0) return 0;
  state_ = BusState::up;
  const auto filled = static_cast<std::size_t>(count);
  for (std::size_t i = 0; i < filled; ++i) {
    mmsghdr& message = messages_[i];
    into[i] = to_entry(slots_[i].frame, message.msg_len == CANFD_MTU);
    into[i].interface = interface;
    // The kernel marks what a program of this machine has sent. [Documentation/networking/can.rst, 4.1.7]
    into[i].direction =
        (message.msg_hdr.msg_flags & MSG_DONTROUTE) != 0 ? log::Direction::sent : log::Direction::received;
    read_control(message.msg_hdr, into[i]);
  }
  return filled;
}

int CanCapture::receive(std::size_t room) {
  // The kernel reports an error of the socket once, before the frames that wait in it: they still count. One
  // that does not go away ends it.
  for (int attempt = 0; attempt < most_errors; ++attempt) {
    for (mmsghdr& message : std::span{messages_}.first(room))
      message.msg_hdr.msg_controllen = sizeof Slot::control;
    const int count =
        ::recvmmsg(socket_.get(), messages_.data(), static_cast<unsigned>(room), MSG_DONTWAIT, nullptr);
    if (count >= 0) return count;
    if (errno == EINTR) return 0;
    if (errno == EAGAIN) {
      if (leaving_ != 0) close();
      return 0;
    }
    if (errno == ENETDOWN)
      state_ = BusState::down;
    else
      leaving_ = errno;
  }
  if (leaving_ != 0) close();
  return 0;
}

void CanCapture::read_control(msghdr& message, log::Entry& entry) {
  for (cmsghdr* item = CMSG_FIRSTHDR(&message); item != nullptr; item = CMSG_NXTHDR(&message, item)) {
    if (item->cmsg_level != SOL_SOCKET) continue;
    if (item->cmsg_type == SO_TIMESTAMPNS) {
      timespec stamp{};
      std::memcpy(&stamp, CMSG_DATA(item), sizeof stamp);
      entry.time = to_time(stamp);
    } else if (item->cmsg_type == SO_RXQ_OVFL) {
      std::uint32_t reading = 0;
      std::memcpy(&reading, CMSG_DATA(item), sizeof reading);
      lost_ += drops_.advance(reading);
    }
  }
}

void CanCapture::look() {
  if (state_ == BusState::closed) return;
  count_drops();
  // By index: the interface may have been renamed, or another may have taken the name.
  ifreq request{};
  request.ifr_ifindex = index_;
  if (::ioctl(socket_.get(), SIOCGIFNAME, &request) < 0 ||
      ::ioctl(socket_.get(), SIOCGIFFLAGS, &request) < 0) {
    leaving_ = ENODEV;
    if (!frames_wait()) close();
    return;
  }
  state_ = (request.ifr_flags & IFF_UP) != 0 ? BusState::up : BusState::down;
}

/// SO_RXQ_OVFL comes only with a frame that arrives after the loss, and none may come for a long time.
void CanCapture::count_drops() {
  std::array<std::uint32_t, SK_MEMINFO_VARS> memory{};
  socklen_t size = sizeof memory;
  if (::getsockopt(socket_.get(), SOL_SOCKET, SO_MEMINFO, memory.data(), &size) == 0 &&
      size > SK_MEMINFO_DROPS * sizeof memory[0])
    lost_ += drops_.advance(memory[SK_MEMINFO_DROPS]);
}

/// Unless the kernel says that none do: an error that it reports first says nothing of frames.
bool CanCapture::frames_wait() const {
  return ::recv(socket_.get(), nullptr, 0, MSG_PEEK | MSG_DONTWAIT) >= 0 || errno != EAGAIN;
}

void CanCapture::close() {
  count_drops();
  state_ = BusState::closed;
  failure_ = leaving_ == ENODEV || leaving_ == ENXIO
                 ? transport::detail::gone_failure(name_)
                 : transport::detail::system_failure(name_, "receive from", leaving_);
}

}  // namespace ocm::cli::record
