#include "cli/replay/outlet.hpp"

#include <utility>
#include <vector>

#include "ocm/can/filter.hpp"
#include "ocm/client/command.hpp"

#include "cli/shared/clock.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli::replay {
namespace {

/// In which a bus that was full may have room again.
constexpr base::Duration patience_after_all = std::chrono::milliseconds{200};

}  // namespace

Outlet::Outlet(std::unique_ptr<transport::Bus> bus, const protocol::Catalogue& catalogue)
    : bus_(std::move(bus)),
      outgoing_(*bus_, "replay"),
      takes_fd_(bus_->fd_obstacle().what.empty()),
      index_(catalogue),
      behaviours_(catalogue) {
  // What comes back is not read; one identifier is the least that a bus can be asked for.
  const can::Filter least{can::max_base_id, can::max_base_id};
  if (const auto subscribed = bus_->subscribe({&least, 1}); !subscribed) fail(subscribed.error);
}

Outlet::Sent Outlet::send(const log::Entry& entry, base::Time latest) {
  if (entry.format == can::Format::error) return Sent::error_frame;
  if (entry.is_fd() && !takes_fd_) return Sent::fd_frame;
  const auto frame = entry.classic();
  if (!frame || commanded_motors(index_, *frame) == nullptr) {
    const bool begins = frame && behaviours_.is_begun_by(*frame);
    if (begins && !may_move_now(latest)) return Sent::late;
    outgoing_.send(entry.frame());
    if (frame) behaviours_.sent(*frame);
    ++behind_;
    ++behind_motion_;
    if (begins) motion_sent();
    return Sent::yes;
  }
  if (!is_rest(*frame)) {
    if (!may_move_now(latest)) return Sent::late;
    outgoing_.otherwise_after_the_next(still_moving);
  }
  outgoing_.send(*frame);
  set_point_ = *frame;
  behind_ = 0;
  may_wait_ = false;
  if (!is_rest(*frame)) motion_sent();
  return Sent::yes;
}

void Outlet::motion_sent() {
  behind_motion_ = 0;
  sent_at_ = Clock::now();
  may_wait_ = true;
}

bool Outlet::may_move_now(base::Time latest) {
  if (!outgoing_.all_left(client::longest_without_set_point)) leave_at_rest();
  return Clock::now().time_since_epoch() <= latest.time_since_epoch();
}

void Outlet::expect_motion_left() {
  if (!may_wait_ || Clock::now() - sent_at_ < client::longest_without_set_point) return;
  const auto delivery = bus_->delivery();
  may_wait_ = false;
  if (delivery.known && delivery.pending > behind_motion_) leave_at_rest();
}

void Outlet::leave_at_rest() {
  if (!is_rest(set_point_)) {
    set_point_.data = {};
    behind_ = 0;
    static_cast<void>(bus_->send(set_point_));
  }
  outgoing_.expect_all_left({});
}

void Outlet::expect_all_left() {
  if (outgoing_.all_left(std::chrono::milliseconds{500})) return;
  // What waits came behind the last set point, which is zero.
  if (is_rest(set_point_) && bus_->delivery().pending <= behind_) outgoing_.otherwise({});
  outgoing_.expect_all_left({});
}

void Outlet::expect_open() const {
  auto received = bus_->receive(base::Duration::zero());
  while (received) received = bus_->receive(base::Duration::zero());
  if (received.error == base::Error::closed) fail(bus_->failure());
}

std::string Outlet::end_behaviours() {
  for (const auto& each : behaviours_.all()) {
    outgoing_.send(each.end);
    ++behind_;
  }
  std::string names = behaviours_.names();
  behaviours_.clear();
  return names;
}

std::string Outlet::end_after_all() {
  std::vector<can::Frame> ends;
  if (!is_rest(set_point_)) {
    set_point_.data = {};
    ends.push_back(set_point_);
  }
  const bool travels = !behaviours_.all().empty();
  for (const auto& each : behaviours_.all()) ends.push_back(each.end);
  behaviours_.clear();
  if (ends.empty()) return {};
  bool taken = true;
  for (const can::Frame& frame : ends) taken = outgoing_.is_taken(frame, patience_after_all) && taken;
  if ((taken && outgoing_.all_left(std::chrono::milliseconds{500})) || outgoing_.robot_is_gone()) return {};
  return travels ? still_travelling : still_moving;
}

bool Outlet::rest() {
  if (is_rest(set_point_)) return false;
  set_point_.data = {};
  outgoing_.send(set_point_);
  behind_ = 0;
  return true;
}

}  // namespace ocm::cli::replay
