#include "cli/shared/outgoing.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "ocm/can/any_text.hpp"

#include "cli/shared/clock.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli {
namespace {

/// A full queue of a CAN interface cannot be waited for (ENOBUFS is not signalled by poll), and nothing tells
/// when a frame has left.
constexpr base::Duration look_again = std::chrono::milliseconds{1};

}  // namespace

std::string why_none_leaves(const transport::Bus& bus) {
  if (bus.is_simulated())
    return "the simulator takes none: was it stopped (Ctrl-Z; `fg` lets it go on), or is the machine busy?";
  return "no node acknowledges the frames: is a board powered and connected, and is the bit rate the same?";
}

Outgoing::Outgoing(transport::Bus& bus, std::string verb, std::string otherwise)
    : bus_(bus), verb_(std::move(verb)), otherwise_(std::move(otherwise)) {
  const auto delivery = bus_.delivery();
  if (delivery.obstruction.what.empty()) return;
  give_up(fmt::format("{}; nothing was sent", delivery.obstruction.what), delivery.obstruction.remedy);
}

void Outgoing::send(const can::AnyFrame& frame, base::Duration patience) {
  const auto late = look() + patience;
  for (;;) {
    const auto taken = bus_.send_any(frame);
    const auto now = look();
    if (taken.error == base::Error::closed) leave_gone();
    if (!taken) {
      if (auto obstacle = frame.is_fd() ? bus_.fd_obstacle() : transport::Failure{}; !obstacle.what.empty())
        give_up(fmt::format("{} is a CAN FD frame, and {}", can::to_text(frame).view(), obstacle.what),
                obstacle.remedy);
      fail({fmt::format("{} cannot be sent: {}", can::to_text(frame).view(), base::describe(taken.error)),
            "only data and remote frames with a valid identifier can, of up to 8 bytes; CAN FD of up to 64"});
    }
    if (*taken) return;
    if (const auto delivery = bus_.delivery(); delivery.refused)
      give_up(delivery.obstruction.what, delivery.obstruction.remedy);
    if (now >= late) {
      if (bus_.state() == transport::BusState::down)
        give_up(fmt::format("{} is down: {} was not sent", bus_.name(), can::to_text(frame).view()),
                fmt::format("bring it up: sudo ip link set {} up", bus_.name()));
      give_up(fmt::format("the transmit queue of {} stays full: {} was not sent", bus_.name(),
                          can::to_text(frame).view()),
              why_none_leaves(bus_));
    }
    sleep_for(look_again);
  }
}

bool Outgoing::is_taken(const can::Frame& frame, base::Duration patience) {
  const auto late = Clock::now() + patience;
  for (;;) {
    const auto taken = bus_.send(frame);
    if (!taken || *taken) return taken.ok();
    if (Clock::now() >= late) return false;
    sleep_for(look_again);
  }
}

bool Outgoing::robot_is_gone() const {
  return bus_.state() == transport::BusState::closed && bus_.is_simulated();
}

Clock::time_point Outgoing::look() {
  const auto now = Clock::now();
  stood_still_ = std::max(stood_still_, now - looked_);
  return looked_ = now;
}

bool Outgoing::all_left(base::Duration patience) {
  auto late = Clock::now() + patience;
  std::uint64_t pending = UINT64_MAX;
  for (;;) {
    const auto now = Clock::now();  // before the bus is asked: a stop in between is no silence of the bus
    const auto delivery = bus_.delivery();
    if (delivery.pending < pending) {  // a slow bus takes its time, and is not stuck
      pending = delivery.pending;
      late = Clock::now() + patience;
    }
    if (bus_.state() == transport::BusState::closed) return false;
    if (!delivery.known || delivery.pending == 0) return delivery.obstruction.what.empty();
    if (!delivery.obstruction.what.empty() || now >= late) return false;
    sleep_for(look_again);
  }
}

void Outgoing::expect_all_left(base::Duration patience) {
  if (all_left(patience)) return;
  if (bus_.state() == transport::BusState::closed) leave_gone();
  const auto delivery = bus_.delivery();
  const auto sent = bus_.counters().sent;
  const auto missing = std::min(std::max<std::uint64_t>(delivery.pending, 1), sent);
  const std::string which = sent == 1 ? "the frame" : fmt::format("{} of {} frames", missing, sent);
  const std::string what = fmt::format("{} did not leave {}, and may leave later", which, bus_.name());
  if (!delivery.obstruction.what.empty())
    give_up(fmt::format("{}: {}", what, delivery.obstruction.what), delivery.obstruction.remedy);
  give_up(what, why_none_leaves(bus_));
}

void Outgoing::otherwise(std::string meaning) {
  otherwise_ = std::move(meaning);
  always_ = true;
}

void Outgoing::otherwise_after_the_next(std::string meaning) {
  if (!otherwise_.empty()) {
    if (meaning == still_travelling)
      otherwise_ = std::move(meaning);  // no watchdog ends that: it is the graver
    return;
  }
  otherwise_ = std::move(meaning);
  before_ = bus_.counters().sent;
  always_ = false;
}

bool Outgoing::matters() const {
  if (otherwise_.empty() || always_) return !otherwise_.empty();
  const auto delivery = bus_.delivery();
  return bus_.counters().sent - before_ > (delivery.known ? delivery.pending : 0);
}

void Outgoing::leave_gone() const {
  transport::Failure failure = bus_.failure();
  if (matters() && !robot_is_gone()) failure.what += fmt::format("; {}", otherwise_);
  fail(failure);
}

void Outgoing::give_up(std::string what, std::string remedy) const {
  if (matters()) what += "; " + otherwise_;
  fail({fmt::format("{}: {}", verb_, what), std::move(remedy)});
}

}  // namespace ocm::cli
