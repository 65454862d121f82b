#include "cli/command/timeline.hpp"

#include <algorithm>

#include "cli/shared/interrupt.hpp"

namespace ocm::cli {

void Timeline::carry_out(const client::Command& command) {
  for (const auto& frame : command.frames) send_patiently(*bus_, frame);
  if (command.ends_hold) held_.reset();
  if (!command.hold) return;
  const auto now = Clock::now();
  const auto& hold = *command.hold;
  const auto end = hold.lasting.count() > 0 ? now + hold.lasting : Clock::time_point::max();
  held_ = Held{hold, now + client::hold_period, end};
}

void Timeline::rest() {
  if (!held_) return;
  const can::Frame frame = held_->hold.rest;
  held_.reset();  // before sending: a failure must not come back here
  send_patiently(*bus_, frame);
}

bool Timeline::wait(Clock::time_point until) {
  for (;;) {
    if (interrupted() != 0) return false;
    const auto now = Clock::now();
    if (held_ && now >= held_->end) rest();
    if (held_ && now >= held_->next) {
      send_patiently(*bus_, held_->hold.frame);
      held_->next += client::hold_period;  // absolute: no drift
    }
    if (now >= until) return true;
    auto wake = until;
    if (held_) wake = std::min({wake, held_->next, held_->end});
    const Over over = live_.receive(wake, [&](const can::Received& received) {
      if (on_receive_) on_receive_(received);
      return true;
    });
    if (over == Over::gone) fail(bus_->failure());
  }
}

bool Timeline::wait_for_hold() {
  while (held_)
    if (!wait(std::min(held_->end, Clock::now() + std::chrono::hours{1}))) return false;
  return true;
}

}  // namespace ocm::cli
