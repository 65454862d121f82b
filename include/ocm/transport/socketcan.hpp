/// A CAN interface of Linux (can0, vcan0, slcan0, ...) as a bus: one CAN_RAW socket. Host only.
///
/// - Every frame on the interface is seen, also those that other programs on this machine send; not our own.
/// - CAN FD frames too, where the interface carries them (its MTU is 72, and not 16).
/// - Frames carry the kernel's receive time in nanoseconds (Unix time), taken when the driver handed them
///   over.
/// - Up to 64 frames are read with one system call.
/// - What this socket had no room for is counted exactly (SO_RXQ_OVFL); what the controller had no room for
///   comes as an error frame.
/// - While a controller is bus-off the kernel takes frames and drops them without a word. `delivery` asks for
/// the
///   controller's state, and compares what the driver has sent with what was given to it.
#pragma once

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <linux/sock_diag.h>
#include <memory>
#include <net/if.h>
#include <poll.h>
#include <span>
#include <string>
#include <string_view>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <time.h>
#include <type_traits>
#include <vector>

#include "ocm/can/any_frame.hpp"
#include "ocm/can/text.hpp"
#include "ocm/host/descriptor.hpp"
#include "ocm/host/system_time.hpp"
#include "ocm/transport/bus.hpp"
#include "ocm/transport/interfaces.hpp"

namespace ocm::transport {

/// As the kernel writes it, from its own form. Bytes beyond the length become zero.
[[nodiscard]] inline can::Frame from_socketcan(const can_frame& raw) noexcept {
  can::Frame frame;
  const bool extended = (raw.can_id & CAN_EFF_FLAG) != 0;
  frame.id = raw.can_id & (extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.dlc = std::min(raw.can_dlc, can::max_dlc);
  if ((raw.can_id & CAN_ERR_FLAG) != 0) {
    frame.format = can::Format::error;
    frame.id = raw.can_id & CAN_ERR_MASK;
  } else if ((raw.can_id & CAN_RTR_FLAG) != 0) {
    frame.format = extended ? can::Format::extended_remote : can::Format::base_remote;
  } else {
    frame.format = extended ? can::Format::extended : can::Format::base;
  }
  std::copy_n(std::begin(raw.data), frame.bytes().size(), frame.data.begin());
  return frame;
}

/// The other way. `frame` must be valid (can::validate).
[[nodiscard]] inline can_frame to_socketcan(const can::Frame& frame) noexcept {
  can_frame raw{};
  raw.can_id = frame.id;
  if (can::is_extended(frame.format)) raw.can_id |= CAN_EFF_FLAG;
  if (can::is_remote(frame.format)) raw.can_id |= CAN_RTR_FLAG;
  if (frame.format == can::Format::error) raw.can_id |= CAN_ERR_FLAG;
  raw.can_dlc = frame.dlc;
  std::copy(frame.bytes().begin(), frame.bytes().end(), std::begin(raw.data));
  return raw;
}

/// A CAN FD frame as the kernel writes it. A length that there is not becomes the next that there is, with
/// zeros.
[[nodiscard]] inline can::AnyFrame from_socketcan(const canfd_frame& raw) noexcept {
  can::AnyFrame frame;
  const bool extended = (raw.can_id & CAN_EFF_FLAG) != 0;
  frame.id = raw.can_id & (extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.format = extended ? can::Format::extended : can::Format::base;
  frame.flags = static_cast<std::uint8_t>((raw.flags & (CANFD_BRS | CANFD_ESI)) | can::frame_flag::fd);
  const std::uint8_t given = std::min(raw.len, can::max_fd_length);
  frame.length = can::fd_length(can::fd_dlc(given));
  std::copy_n(std::begin(raw.data), given, frame.data.begin());
  return frame;
}

/// The other way, of a CAN FD frame. `frame` must be valid (can::validate).
[[nodiscard]] inline canfd_frame to_socketcan_fd(const can::AnyFrame& frame) noexcept {
  canfd_frame raw{};
  raw.can_id = frame.id | (can::is_extended(frame.format) ? CAN_EFF_FLAG : 0);
  raw.len = frame.length;
  raw.flags = static_cast<__u8>(frame.flags & (CANFD_BRS | CANFD_ESI));
  std::copy(frame.bytes().begin(), frame.bytes().end(), std::begin(raw.data));
  return raw;
}

/// Accepts base data frames only, as can::Filter does: the format bits are compared too.
[[nodiscard]] inline can_filter to_socketcan(const can::Filter& filter) noexcept {
  return {filter.id & CAN_SFF_MASK, (filter.mask & CAN_SFF_MASK) | CAN_EFF_FLAG | CAN_RTR_FLAG};
}

namespace detail {

/// The kernel's count of frames that found the receive buffer full: 32 bits that wrap, and that arrive out of
/// order when they are read from two places.
class DropCounter {
 public:
  /// How many frames more than at the last call; 0 for an older reading.
  [[nodiscard]] constexpr std::uint32_t advance(std::uint32_t reading) noexcept {
    const std::uint32_t more = reading - last_;
    if (more > INT32_MAX) return 0;
    last_ = reading;
    return more;
  }

 private:
  std::uint32_t last_ = 0;
};

[[nodiscard]] inline std::string list_interfaces(std::span<const CanInterface> interfaces) {
  std::string text;
  for (const CanInterface& interface : interfaces) {
    if (!text.empty()) text += ", ";
    text += interface.name;
    if (!interface.up) text += " (down)";
  }
  return text;
}

/// Whether the kernel could have an interface of this name. It takes what follows a colon for an alias.
[[nodiscard]] constexpr bool can_be_interface(std::string_view name) noexcept {
  return !name.empty() && name.size() < IFNAMSIZ && name.find_first_of(":/ \t\n") == std::string_view::npos;
}

[[nodiscard]] inline Failure name_failure(std::string_view name) {
  if (name.empty())
    return {"the name of the CAN interface is empty", "name one, such as can0: `ip link show type can`"};
  return {"'" + std::string(name) + "' has " + std::to_string(name.size()) +
              " characters; an interface name has at most 15",
          "see `ip link show type can` for the names"};
}

[[nodiscard]] inline Failure missing_failure(std::string_view name, std::span<const CanInterface> existing) {
  const std::string what = "there is no interface '" + std::string(name) + "'";
  if (existing.empty())
    return {what + ", nor any CAN interface",
            "plug in an adapter and look for it with `ip link show type can`, or make a virtual one: sudo "
            "ip link add vcan0 type vcan && sudo ip link set vcan0 up"};
  return {what, "the CAN interfaces here are: " + list_interfaces(existing) +
                    " (see also `ip link show type can`)"};
}

[[nodiscard]] inline Failure wrong_type_failure(std::string_view name,
                                                std::span<const CanInterface> existing) {
  return {"'" + std::string(name) + "' is not a CAN interface",
          existing.empty() ? "this machine has none: `ip link show type can`"
                           : "the CAN interfaces here are: " + list_interfaces(existing)};
}

[[nodiscard]] inline Failure down_failure(std::string_view name, std::span<const CanInterface> existing) {
  const auto found = std::find_if(existing.begin(), existing.end(),
                                  [&](const CanInterface& other) { return other.name == name; });
  const bool has_bit_rate = found == existing.end() || found->kind == "can" || found->kind.empty();
  return {"interface '" + std::string(name) + "' is down",
          "sudo ip link set " + std::string(name) + " up" + (has_bit_rate ? " type can bitrate 500000" : "")};
}

/// An interface whose frames have room for eight bytes: CAN FD is off there.
[[nodiscard]] inline Failure no_fd_failure(std::string_view name, std::span<const CanInterface> existing) {
  const auto found = std::find_if(existing.begin(), existing.end(),
                                  [name](const CanInterface& interface) { return interface.name == name; });
  const bool is_virtual = found != existing.end() && (found->kind == "vcan" || found->kind == "vxcan");
  const std::string link = "sudo ip link set " + std::string(name);
  return {
      "interface '" + std::string(name) + "' carries no CAN FD frames: its MTU is 16, and not 72",
      link + " down; " + link +
          (is_virtual ? " mtu 72; " + link + " up"
                      : " up type can bitrate 500000 dbitrate 2000000 fd on, if its controller has CAN FD")};
}

[[nodiscard]] inline Failure gone_failure(std::string_view name) {
  return {"interface '" + std::string(name) + "' is gone: unplugged or deleted",
          "plug it in, bring it up (sudo ip link set " + std::string(name) +
              " up type can bitrate 500000) and start again"};
}

[[nodiscard]] inline Failure system_failure(std::string_view name, std::string_view action, int error) {
  return {"cannot " + std::string(action) + " interface '" + std::string(name) + "': " + std::strerror(error),
          "see `ip -details -statistics link show " + std::string(name) + "` and the kernel's log (dmesg)"};
}

}  // namespace detail

struct SocketCanOptions {
  /// Room for frames that wait to be read, asked of the kernel, which gives twice as much and charges 768
  /// bytes for each (linux 6.1): 32 MiB hold 87000 frames, 10 s of a full bus at 1 Mbit/s. Without
  /// CAP_NET_ADMIN the limit is /proc/sys/net/core/rmem_max.
  int receive_buffer_bytes = 32 << 20;
};

class SocketCan final : public Bus {
 public:
  /// Opens an interface that is up. The failure says which of these was not so, and what to type.
  [[nodiscard]] static Outcome<std::unique_ptr<SocketCan>> open(std::string_view interface,
                                                                SocketCanOptions options = {}) {
    if (interface.empty() || interface.size() >= IFNAMSIZ) return detail::name_failure(interface);
    host::Descriptor socket{::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_RAW)};
    if (!socket) return can_socket_failure(errno);

    if (!detail::can_be_interface(interface)) return detail::missing_failure(interface, can_interfaces());
    ifreq request = named(interface);
    if (::ioctl(socket.get(), SIOCGIFINDEX, &request) < 0)
      return errno == ENODEV ? detail::missing_failure(interface, can_interfaces())
                             : detail::system_failure(interface, "find", errno);
    const int index = request.ifr_ifindex;
    if (::ioctl(socket.get(), SIOCGIFHWADDR, &request) < 0)
      return detail::system_failure(interface, "find", errno);
    if (request.ifr_hwaddr.sa_family != can_hardware_type)
      return detail::wrong_type_failure(interface, can_interfaces());
    if (interface_state(socket.get(), index) != BusState::up)
      return detail::down_failure(interface, can_interfaces());

    if (const int error = configure(socket.get(), options); error != 0)
      return detail::system_failure(interface, "configure", error);
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = index;
    if (::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) < 0)
      return detail::system_failure(interface, "open", errno);
    auto bus = std::unique_ptr<SocketCan>(new SocketCan(std::move(socket), interface, index));
    if (const auto link = query_can_interface(index)) bus->sent_before_ = link->sent;
    return bus;
  }

  [[nodiscard]] std::string_view name() const override { return name_; }

  /// Never waits. Refused are: a full queue of the interface (ENOBUFS, which no poll announces the end of:
  /// try again after a millisecond), a full send buffer (EAGAIN), an interface that is down (`state`).
  base::Result<bool> send(const can::Frame& frame) override {
    if (state_ == BusState::closed) return base::Error::closed;
    if (frame.format == can::Format::error) return base::Error::bad_identifier;  // nothing for the wire
    if (const auto valid = can::validate(frame); !valid) return valid.error;
    const can_frame raw = to_socketcan(frame);
    return hand_over(&raw, sizeof raw);
  }

  /// A CAN FD frame for an interface without CAN FD is refused with Error::bad_length.
  base::Result<bool> send_any(const can::AnyFrame& frame) override {
    if (const auto classic = frame.classic()) return send(*classic);
    if (state_ == BusState::closed) return base::Error::closed;
    if (const auto valid = can::validate(frame); !valid) return valid.error;
    const canfd_frame raw = to_socketcan_fd(frame);
    return hand_over(&raw, sizeof raw);
  }

  /// Asks the kernel: the interface may have been set up again.
  [[nodiscard]] Failure fd_obstacle() const override {
    if (mtu() == CANFD_MTU || state_ == BusState::closed) return {};
    return detail::no_fd_failure(name_, can_interfaces());
  }

  /// A signal that is caught while this waits ends it with Error::timed_out; one that comes just before does
  /// not, so wait no longer than the signal may take. When the interface goes down or comes back the same
  /// error comes at once, and `state` has changed; while it is down it is looked at every 50 ms.
  base::Result<can::Received> receive(base::Duration timeout) override {
    return receive_next<can::Received>(timeout);
  }
  base::Result<ReceivedAny> receive_any(base::Duration timeout) override {
    return receive_next<ReceivedAny>(timeout);
  }

  /// The kernel filters: what does not pass costs this process nothing. At most 512 filters. Frames that
  /// waited in the queue before are filtered here.
  Outcome<void> subscribe(std::span<const can::Filter> filters) override {
    if (filters.size() > CAN_RAW_FILTER_MAX)
      return Failure{
          std::to_string(filters.size()) + " filters for interface '" + name_ + "'; the kernel takes 512",
          "use fewer filters with wider masks, or none"};
    std::vector<can_filter> raw;
    raw.reserve(filters.size() + 1);
    for (const can::Filter& filter : filters) raw.push_back(to_socketcan(filter));
    if (raw.empty()) raw.push_back(can_filter{});  // no filter at all would mean no frame at all
    if (::setsockopt(socket_.get(), SOL_CAN_RAW, CAN_RAW_FILTER, raw.data(),
                     static_cast<socklen_t>(raw.size() * sizeof raw.front())) < 0)
      return detail::system_failure(name_, "set the filters of", errno);
    filters_.assign(filters.begin(), filters.end());
    filtered_since_ = unix_time();
    return {};
  }

  /// By the driver's count of frames that left, which counts those of other programs, too: what is pending
  /// may be more.
  [[nodiscard]] Delivery delivery() override {
    const auto link = query_can_interface(index_);
    if (!link) return {};
    Delivery delivery{.known = true};
    const std::uint64_t left = link->sent - sent_before_;
    delivery.pending = counters_.sent > left ? counters_.sent - left : 0;
    if (link->bus_off)
      delivery.obstruction = {
          "'" + name_ + "' is bus-off: its controller has left the bus after too many errors",
          "mend the cable, the termination or the bit rate; then: sudo ip link set " + name_ +
              " type can restart"};
    else if (!link->up)
      delivery.obstruction = detail::down_failure(name_, std::span{&*link, 1});
    return delivery;
  }

  [[nodiscard]] int descriptor() const override { return socket_.get(); }
  [[nodiscard]] const BusCounters& counters() const override { return counters_; }
  [[nodiscard]] BusState state() const override { return state_; }
  [[nodiscard]] const Failure& failure() const override { return failure_; }

 private:
  static constexpr std::size_t batch_size = 64;
  static constexpr base::Duration look_while_down = std::chrono::milliseconds{50};
  static constexpr std::size_t control_size =
      CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(std::uint32_t));

  enum class Filled : std::uint8_t { frames, nothing, changed, interrupted };

  /// Where recvmmsg puts one frame and what comes with it.
  struct Slot {
    canfd_frame frame{};  ///< a classic frame fills the first 16 bytes
    iovec place{};
    alignas(cmsghdr) std::array<std::byte, control_size> control{};
  };

  SocketCan(host::Descriptor socket, std::string_view interface, int index)
      : socket_(std::move(socket)), name_(interface), index_(index) {
    for (std::size_t i = 0; i < batch_size; ++i) {
      Slot& slot = slots_[i];
      slot.place = {&slot.frame, sizeof slot.frame};
      messages_[i].msg_hdr.msg_iov = &slot.place;
      messages_[i].msg_hdr.msg_iovlen = 1;
      messages_[i].msg_hdr.msg_control = slot.control.data();
    }
  }

  /// `receive` and `receive_any`.
  template <class R>
  base::Result<R> receive_next(base::Duration timeout) {
    R received;
    if (take(received)) return received;
    const auto begin = std::chrono::steady_clock::now();
    for (;;) {
      const bool was_closed = state_ == BusState::closed;
      switch (fill()) {
        case Filled::frames:
          if (take(received)) return received;
          continue;
        case Filled::changed:
          if (state_ != BusState::closed) return base::Error::timed_out;
          if (!was_closed)
            continue;  // the kernel tells of the end first; what waits in the queue still counts
          return base::Error::closed;
        case Filled::interrupted:
          return base::Error::timed_out;
        case Filled::nothing:
          read_drops();
          if (state_ == BusState::closed) return base::Error::closed;
          break;
      }
      if (state_ == BusState::down) {
        const BusState now = interface_state(socket_.get(), index_);
        if (now == BusState::closed) return close(detail::gone_failure(name_));
        if (now == BusState::up) {
          state_ = BusState::up;
          return base::Error::timed_out;
        }
      }
      base::Duration rest = timeout - (std::chrono::steady_clock::now() - begin);
      if (timeout <= base::Duration::zero() || rest <= base::Duration::zero()) return base::Error::timed_out;
      if (state_ == BusState::down) rest = std::min(rest, look_while_down);
      if (!wait(rest)) return base::Error::timed_out;
    }
  }

  /// Of the interface, by index; 0 where it is gone.
  [[nodiscard]] int mtu() const noexcept {
    ifreq request{};
    request.ifr_ifindex = index_;
    const int socket = socket_.get();
    return ::ioctl(socket, SIOCGIFNAME, &request) == 0 && ::ioctl(socket, SIOCGIFMTU, &request) == 0
               ? request.ifr_mtu
               : 0;
  }

  /// To the kernel: can_frame or canfd_frame.
  base::Result<bool> hand_over(const void* raw, std::size_t size) {
    for (;;) {
      if (::send(socket_.get(), raw, size, MSG_DONTWAIT | MSG_NOSIGNAL) == static_cast<ssize_t>(size)) {
        ++counters_.sent;
        state_ = BusState::up;
        return true;
      }
      const int error = errno;
      switch (error) {
        case EINTR:
          continue;
        case EAGAIN:
        case ENOBUFS:
        case ENOMEM:
          ++counters_.refused;
          return false;
        case EINVAL:  // what the kernel answers to 72 bytes where the interface has room for 16
        case EMSGSIZE:
          if (size == CANFD_MTU && mtu() == CAN_MTU) return base::Error::bad_length;
          break;
        default:
          break;
      }
      if (lose("send on", error) == BusState::closed) return base::Error::closed;
      ++counters_.refused;
      return false;
    }
  }

  [[nodiscard]] static ifreq named(std::string_view interface) noexcept {
    ifreq request{};
    std::copy(interface.begin(), interface.end(), std::begin(request.ifr_name));
    return request;
  }

  /// By index: the interface may have been renamed, or another may have taken the name.
  [[nodiscard]] static BusState interface_state(int socket, int index) noexcept {
    ifreq request{};
    request.ifr_ifindex = index;
    if (::ioctl(socket, SIOCGIFNAME, &request) < 0 || ::ioctl(socket, SIOCGIFFLAGS, &request) < 0)
      return BusState::closed;
    return (request.ifr_flags & IFF_UP) != 0 ? BusState::up : BusState::down;
  }

  /// 0 or errno.
  [[nodiscard]] static int configure(int socket, const SocketCanOptions& options) noexcept {
    const auto set = [socket](int level, int name, const auto& value) {
      return ::setsockopt(socket, level, name, &value, sizeof value) == 0;
    };
    const can_err_mask_t all_errors = CAN_ERR_MASK;
    const int on = 1;
    // Also where the interface has no CAN FD now: it may be set up again while this socket is open.
    if (!set(SOL_CAN_RAW, CAN_RAW_ERR_FILTER, all_errors) || !set(SOL_CAN_RAW, CAN_RAW_FD_FRAMES, on) ||
        !set(SOL_SOCKET, SO_TIMESTAMPNS, on) || !set(SOL_SOCKET, SO_RXQ_OVFL, on))
      return errno;
    if (!set(SOL_SOCKET, SO_RCVBUFFORCE, options.receive_buffer_bytes) &&
        !set(SOL_SOCKET, SO_RCVBUF, options.receive_buffer_bytes))
      return errno;
    return 0;
  }

  [[nodiscard]] static base::Time unix_time() noexcept {
    timespec now{};
    ::clock_gettime(CLOCK_REALTIME, &now);
    return to_time(now);
  }
  [[nodiscard]] static base::Time to_time(const timespec& time) noexcept {
    return base::Time{std::chrono::seconds{time.tv_sec} + std::chrono::nanoseconds{time.tv_nsec}};
  }

  /// Error::timed_out is the caller's part. True: something may have come.
  [[nodiscard]] bool wait(base::Duration time) const noexcept {
    const timespec limit = host::to_timespec(time);
    pollfd entry{socket_.get(), POLLIN, 0};
    return ::ppoll(&entry, 1, &limit, nullptr) >= 0;
  }

  [[nodiscard]] Filled fill() {
    for (mmsghdr& message : messages_) message.msg_hdr.msg_controllen = control_size;
    const int count = ::recvmmsg(socket_.get(), messages_.data(), batch_size, MSG_DONTWAIT, nullptr);
    next_ = 0;
    filled_ = count > 0 ? static_cast<std::size_t>(count) : 0;
    if (count > 0) return Filled::frames;
    if (count == 0 || errno == EAGAIN) return Filled::nothing;
    if (errno == EINTR) return Filled::interrupted;
    lose("receive from", errno);
    return Filled::changed;
  }

  /// The next frame of the batch that is of the wanted kind, if one is left.
  template <class R>
  [[nodiscard]] bool take(R& received) {
    while (next_ < filled_) {
      const std::size_t i = next_++;
      received.time = base::Time::min();
      read_control(messages_[i].msg_hdr, received.time);
      if (received.time == base::Time::min()) received.time = unix_time();
      if (messages_[i].msg_len == CANFD_MTU) {
        if constexpr (std::is_same_v<R, ReceivedAny>) {
          received.frame = from_socketcan(slots_[i].frame);
        } else {
          ++counters_.passed_over;
          continue;
        }
      } else {
        can_frame raw;
        std::memcpy(&raw, &slots_[i].frame, sizeof raw);
        received.frame = from_socketcan(raw);
      }
      const bool error = received.frame.format == can::Format::error;
      if (!error && received.time <= filtered_since_ && !passes(received.frame.id, received.frame.format))
        continue;
      ++counters_.received;
      if (error) ++counters_.error_frames;
      return true;
    }
    return false;
  }

  [[nodiscard]] bool passes(std::uint32_t id, can::Format format) const noexcept {
    return filters_.empty() || std::any_of(filters_.begin(), filters_.end(), [&](const can::Filter& filter) {
             return filter.accepts(id, format);
           });
  }

  void read_control(msghdr& message, base::Time& time) noexcept {
    for (cmsghdr* item = CMSG_FIRSTHDR(&message); item != nullptr; item = CMSG_NXTHDR(&message, item)) {
      if (item->cmsg_level != SOL_SOCKET) continue;
      if (item->cmsg_type == SO_TIMESTAMPNS) {
        timespec stamp{};
        std::memcpy(&stamp, CMSG_DATA(item), sizeof stamp);
        time = to_time(stamp);
      } else if (item->cmsg_type == SO_RXQ_OVFL) {
        std::uint32_t reading = 0;
        std::memcpy(&reading, CMSG_DATA(item), sizeof reading);
        counters_.lost += drops_.advance(reading);
      }
    }
  }

  /// SO_RXQ_OVFL comes only with a frame that arrives after the loss. When the queue has run dry, ask: none
  /// may come for a long time.
  void read_drops() noexcept {
    std::array<std::uint32_t, SK_MEMINFO_VARS> memory{};
    socklen_t size = sizeof memory;
    if (::getsockopt(socket_.get(), SOL_SOCKET, SO_MEMINFO, memory.data(), &size) == 0 &&
        size > SK_MEMINFO_DROPS * sizeof memory[0])
      counters_.lost += drops_.advance(memory[SK_MEMINFO_DROPS]);
  }

  base::Error close(Failure failure) {
    state_ = BusState::closed;
    failure_ = std::move(failure);
    return base::Error::closed;
  }

  /// What an error of the socket means for the bus.
  BusState lose(std::string_view action, int error) {
    if (error == ENETDOWN)
      state_ = BusState::down;
    else if (error == ENODEV || error == ENXIO)
      close(detail::gone_failure(name_));
    else
      close(detail::system_failure(name_, action, error));
    return state_;
  }

  host::Descriptor socket_;
  std::string name_;
  int index_;
  BusState state_ = BusState::up;
  Failure failure_;
  BusCounters counters_;
  detail::DropCounter drops_;
  std::uint64_t sent_before_ = 0;  ///< frames that had left when this was opened
  std::vector<can::Filter> filters_;
  base::Time filtered_since_ = base::Time::min();
  std::size_t next_ = 0;    ///< in the batch
  std::size_t filled_ = 0;  ///< frames in the batch
  std::array<Slot, batch_size> slots_{};
  std::array<mmsghdr, batch_size> messages_{};
};

}  // namespace ocm::transport
