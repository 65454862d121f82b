#include "cli/replay/outlet.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <utility>

#include <fmt/format.h>

#include "ocm/can/filter.hpp"
#include "ocm/transport/socketcan.hpp"

#include "cli/shared/clock.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/set_points.hpp"

namespace ocm::cli::replay {
namespace {

/// Whether frames of 64 bytes fit through: a CAN interface in FD mode, or a virtual one set up for it.
bool allow_fd(const transport::Bus& bus) {
  if (dynamic_cast<const transport::SocketCan*>(&bus) == nullptr) return false;
  ifreq request{};
  bus.name().copy(request.ifr_name, IFNAMSIZ - 1);
  const int on = 1;
  return ::ioctl(bus.descriptor(), SIOCGIFMTU, &request) == 0 && request.ifr_mtu == CANFD_MTU &&
         ::setsockopt(bus.descriptor(), SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof on) == 0;
}

canfd_frame to_raw(const log::Entry& entry) noexcept {
  canfd_frame raw{};
  raw.can_id = entry.id | (can::is_extended(entry.format) ? CAN_EFF_FLAG : 0);
  raw.len = entry.length;
  raw.flags = static_cast<__u8>(entry.flags & (CANFD_BRS | CANFD_ESI));
  const auto bytes = entry.bytes();
  std::copy(bytes.begin(), bytes.end(), std::begin(raw.data));
  return raw;
}

}  // namespace

Outlet::Outlet(std::unique_ptr<transport::Bus> bus, const protocol::Catalogue& catalogue)
    : bus_(std::move(bus)), outgoing_(*bus_, "replay"), takes_fd_(allow_fd(*bus_)), index_(catalogue) {
  // What comes back is not read; one identifier is the least that a bus can be asked for.
  const can::Filter least{can::max_base_id, can::max_base_id};
  if (const auto subscribed = bus_->subscribe({&least, 1}); !subscribed) fail(subscribed.error);
}

Outlet::Sent Outlet::send(const log::Entry& entry) {
  if (entry.format == can::Format::error) return Sent::error_frame;
  if (const auto frame = entry.classic()) {
    outgoing_.send(*frame);
    if (commanded_motors(index_, *frame) != nullptr) set_point_ = *frame;
    return Sent::yes;
  }
  if (!takes_fd_) return Sent::fd_frame;
  const auto give_up = Clock::now() + std::chrono::seconds{1};
  while (!send_fd(entry)) {
    if (Clock::now() >= give_up)
      fail({fmt::format("{} takes no more CAN FD frames: {}", name(), std::strerror(errno)),
            "is it up, and does a node that knows CAN FD acknowledge?"});
    sleep_for(std::chrono::milliseconds{1});
  }
  return Sent::yes;
}

void Outlet::expect_open() const {
  auto received = bus_->receive(base::Duration::zero());
  while (received) received = bus_->receive(base::Duration::zero());
  if (received.error == base::Error::closed) fail(bus_->failure());
}

bool Outlet::rest() {
  if (is_rest(set_point_)) return false;
  set_point_.data = {};
  outgoing_.send(set_point_);
  return true;
}

bool Outlet::send_fd(const log::Entry& entry) const {
  const canfd_frame raw = to_raw(entry);
  return ::send(bus_->descriptor(), &raw, CANFD_MTU, MSG_DONTWAIT | MSG_NOSIGNAL) == CANFD_MTU;
}

}  // namespace ocm::cli::replay
