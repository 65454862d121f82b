#include "cli/shared/live.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli {
namespace {

/// A signal that comes just before a wait is seen after so long at most.
constexpr Live::Clock::duration longest_wait = std::chrono::milliseconds{200};
constexpr Live::Clock::duration between_looks_beside = std::chrono::milliseconds{10};

}  // namespace

void StateWatch::look(const transport::Bus& bus) {
  if (bus.state() == state_) return;
  state_ = bus.state();
  if (state_ == transport::BusState::down)
    remark(fmt::format("{} went down; waiting for it to come back", bus.name()));
  if (state_ == transport::BusState::up) remark(fmt::format("{} is up again", bus.name()));
}

void Live::wait_for_both(Clock::duration longest) {
  std::array inputs{pollfd{beside_.descriptor, POLLIN, 0}, pollfd{bus_->descriptor(), POLLIN, 0}};
  if (!wait_for_input(inputs, longest) || inputs[1].revents != 0) return;
  beside_waits_ = false;
  beside_.serve();
}

void Live::look_beside() {
  const auto now = Clock::now();
  if (now - looked_beside_ < between_looks_beside) return;
  looked_beside_ = now;
  pollfd input{beside_.descriptor, POLLIN, 0};
  const bool waited = beside_waits_;
  beside_waits_ = wait_for_input(std::span{&input, 1}, Clock::duration{0});
  if (!waited || !beside_waits_) return;
  beside_waits_ = false;
  beside_.serve();
}

/// Among frames that come without end: what it has worked for beyond `until`. A time for which the program
/// was stopped is none of that; what came meanwhile is taken.
bool Live::is_overdue(Clock::time_point until) {
  constexpr unsigned between_looks = 64;
  constexpr std::chrono::milliseconds longest_work{100};
  constexpr std::chrono::seconds longest_overrun{1};
  if (!idle_ || ++frames_ % between_looks != 0) return false;
  const auto now = Clock::now();
  const auto worked = std::min<Clock::duration>(now - looked_, longest_work);
  looked_ = now;
  if (now >= until) overrun_ += worked;
  return overrun_ >= longest_overrun;
}

template <class Ask, class GiveTo>
Over Live::receive_next(Clock::time_point until, const Ask& ask, const GiveTo& take) {
  bool all_taken = !idle_;
  overrun_ = {};
  looked_ = Clock::now();
  while (interrupted() == 0) {
    Clock::duration left{0};
    if (all_taken) {
      left = until - Clock::now();
      if (left.count() <= 0) return Over::time;
      left = std::min(left, longest_wait);
    }
    const bool waits_here = beside_.descriptor >= 0 && left.count() > 0;
    const auto received = ask(waits_here ? Clock::duration{0} : left);
    state_.look(*bus_);
    if (received) {
      all_taken = !idle_;
      if (!take(*received)) return Over::enough;
      if (is_overdue(until)) return Over::time;
      if (beside_.descriptor >= 0) look_beside();
      continue;
    }
    if (received.error == base::Error::closed) return Over::gone;
    if (!all_taken) idle_();
    all_taken = true;
    if (!waits_here) continue;
    wait_for_both(left);
    all_taken = !idle_;  // what has come meanwhile goes before the time
  }
  return Over::signal;
}

Over Live::receive(Clock::time_point until, const Take& take) {
  return receive_next(
      until, [this](base::Duration left) { return bus_->receive(left); }, take);
}

Over Live::receive_any(Clock::time_point until, const TakeAny& take) {
  return receive_next(
      until, [this](base::Duration left) { return bus_->receive_any(left); }, take);
}

Over Live::receive_or_leave(Clock::time_point until, const Take& take) {
  const Over over = receive(until, take);
  if (over == Over::gone) fail(bus_->failure());
  if (over == Over::signal) throw Exit{exit_code_after_interrupt(exit_failure)};
  return over;
}

}  // namespace ocm::cli
