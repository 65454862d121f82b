/// Doing things at their times while the bus stays awake: waits until an absolute time, takes what comes from
/// the bus meanwhile, and repeats a held set point every 100 ms. Shared by drive and run.
#pragma once

#include <chrono>
#include <functional>
#include <optional>

#include "ocm/can/bus.hpp"
#include "ocm/transport/bus.hpp"

#include "cli/shared/live.hpp"
#include "cli/shared/session.hpp"
#include "cli/words/command.hpp"

namespace ocm::cli {

class Timeline {
 public:
  using Clock = Live::Clock;
  /// `on_receive` gets every frame that comes while waiting; empty: nobody looks at them.
  Timeline(transport::Bus& bus, std::function<void(const can::Received&)> on_receive)
      : bus_(&bus), on_receive_(std::move(on_receive)), live_(bus) {}

  /// Sends a command's frames and takes over, or ends, its hold.
  void carry_out(const client::Command& command);
  /// Waits until `until`, repeating and receiving. False: a signal came first.
  [[nodiscard]] bool wait(Clock::time_point until);
  /// Until the hold is over by itself (drive --for) or a signal comes. False: a signal.
  [[nodiscard]] bool wait_for_hold();
  /// Ends a hold: sends the set point of rest. Nothing without a hold.
  void rest();

 private:
  struct Held {
    client::Hold hold;
    Clock::time_point next;
    Clock::time_point end;
  };
  transport::Bus* bus_;
  std::function<void(const can::Received&)> on_receive_;
  std::optional<Held> held_;
  Live live_;
};

}  // namespace ocm::cli
