#include "cli/replay/outlet.hpp"

#include <utility>

#include "ocm/can/filter.hpp"

#include "cli/shared/messages.hpp"
#include "cli/shared/set_points.hpp"

namespace ocm::cli::replay {

Outlet::Outlet(std::unique_ptr<transport::Bus> bus, const protocol::Catalogue& catalogue)
    : bus_(std::move(bus)),
      outgoing_(*bus_, "replay"),
      takes_fd_(bus_->fd_obstacle().what.empty()),
      index_(catalogue) {
  // What comes back is not read; one identifier is the least that a bus can be asked for.
  const can::Filter least{can::max_base_id, can::max_base_id};
  if (const auto subscribed = bus_->subscribe({&least, 1}); !subscribed) fail(subscribed.error);
}

Outlet::Sent Outlet::send(const log::Entry& entry) {
  if (entry.format == can::Format::error) return Sent::error_frame;
  if (entry.is_fd() && !takes_fd_) return Sent::fd_frame;
  outgoing_.send(entry.frame());
  if (const auto frame = entry.classic(); frame && commanded_motors(index_, *frame) != nullptr)
    set_point_ = *frame;
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

}  // namespace ocm::cli::replay
