#include "cli/shared/live.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli {
namespace {

/// A signal that comes just before a wait is seen after so long at most.
constexpr Live::Clock::duration longest_wait = std::chrono::milliseconds{200};

}  // namespace

void StateWatch::look(const transport::Bus& bus) {
  if (bus.state() == state_) return;
  state_ = bus.state();
  if (state_ == transport::BusState::down)
    remark(fmt::format("{} went down; waiting for it to come back", bus.name()));
  if (state_ == transport::BusState::up) remark(fmt::format("{} is up again", bus.name()));
}

Over Live::receive(Clock::time_point until, const Take& take) {
  bool all_taken = !idle_;
  while (interrupted() == 0) {
    Clock::duration left{0};
    if (all_taken) {
      left = until - Clock::now();
      if (left.count() <= 0) return Over::time;
      left = std::min(left, longest_wait);
    }
    const auto received = bus_->receive(left);
    state_.look(*bus_);
    if (received) {
      all_taken = !idle_;
      if (!take(*received)) return Over::enough;
      continue;
    }
    if (received.error == base::Error::closed) return Over::gone;
    if (!all_taken) idle_();
    all_taken = true;
  }
  return Over::signal;
}

Over Live::receive_or_leave(Clock::time_point until, const Take& take) {
  const Over over = receive(until, take);
  if (over == Over::gone) fail(bus_->failure());
  if (over == Over::signal) throw Exit{exit_code_after_interrupt(exit_failure)};
  return over;
}

}  // namespace ocm::cli
