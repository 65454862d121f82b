#include "cli/command/timeline.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"
#include "cli/words/quantity.hpp"

namespace ocm::cli {

Timeline::Timeline(transport::Bus& bus, std::string verb,
                   std::function<void(const can::Received&)> on_receive)
    : bus_(&bus),
      verb_(std::move(verb)),
      on_receive_(std::move(on_receive)),
      live_(bus),
      outgoing_(bus, verb_, still_moving) {}

void Timeline::carry_out(const client::Command& command) {
  for (const auto& frame : command.frames) outgoing_.send(frame);
  if (command.ends_hold) held_.reset();
  if (!command.hold) return;
  const auto now = Clock::now();
  const auto& hold = *command.hold;
  const auto end = hold.lasting.count() > 0 ? now + hold.lasting : Clock::time_point::max();
  held_ = Held{hold, now + client::hold_period, end, now};
}

void Timeline::rest() {
  if (!held_) return;
  const can::Frame frame = held_->hold.rest;
  held_.reset();  // before sending: a failure must not come back here
  outgoing_.send(frame);
}

void Timeline::finish() {
  rest();
  outgoing_.expect_all_left();
  if (withheld_ != 0)
    remark(fmt::format("{}: {} set points were not sent, because the one before had not left", verb_,
                       withheld_));
}

void Timeline::abandon(std::string what, std::string remedy) {
  const can::Frame frame = held_->hold.rest;
  held_.reset();
  // One set point may still wait somewhere; nothing but rest comes behind it.
  const auto taken = bus_->send(frame);
  const bool rests = taken && *taken && outgoing_.all_left(std::chrono::seconds{1});
  fail({fmt::format("{}: {}; {}", verb_, what, rests ? "the motors were set to zero" : still_moving),
        std::move(remedy)});
}

void Timeline::repeat(Clock::time_point now) {
  constexpr auto longest = client::longest_without_set_point;
  const auto in_words = [now](Clock::time_point since) {
    return words::to_text(std::chrono::duration_cast<std::chrono::milliseconds>(now - since));
  };
  const auto last_turn = held_->next - client::hold_period;
  if (now - last_turn >= longest)
    abandon(fmt::format("this program stood still for {}, and drives no further", in_words(last_turn)),
            "was it stopped, or did the machine sleep? Give the command again");
  // Late set points are dropped: each holds only at its own time.
  held_->next += client::hold_period;  // absolute: no drift
  if (held_->next <= now) held_->next = now + client::hold_period;
  const auto delivery = bus_->delivery();
  const auto& obstruction = delivery.obstruction;
  if (!obstruction.what.empty() || (delivery.known && delivery.pending != 0)) {
    ++withheld_;
    if (now - held_->left < longest) return;  // an interface may come back
    const std::string what =
        fmt::format("no set point has left {} for {}", bus_->name(), in_words(held_->left));
    if (!obstruction.what.empty()) abandon(fmt::format("{}: {}", what, obstruction.what), obstruction.remedy);
    abandon(what, not_acknowledged);
  }
  const auto taken = bus_->send(held_->hold.frame);
  if (taken.error == base::Error::closed) fail(bus_->failure());
  if (taken && *taken)
    held_->left = now;
  else if (++withheld_; now - held_->left >= longest)
    abandon(fmt::format("the transmit queue of {} has been full for {}", bus_->name(), in_words(held_->left)),
            not_acknowledged);
}

bool Timeline::wait(Clock::time_point until) {
  for (;;) {
    if (interrupted() != 0) return false;
    const auto now = Clock::now();
    if (held_ && now >= held_->end) rest();
    if (held_ && now >= held_->next) repeat(now);
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
