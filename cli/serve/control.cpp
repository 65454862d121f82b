#include "cli/serve/control.hpp"

#include <algorithm>
#include <chrono>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "cli/serve/commands.hpp"
#include "cli/serve/foxglove.hpp"
#include "cli/serve/parameters.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/outgoing.hpp"
#include "cli/shared/remedies.hpp"
#include "cli/shared/set_points.hpp"

namespace ocm::cli::serve {
namespace {

using namespace std::chrono_literals;

/// From one try of a rest that the bus did not take, and one look at what has left, to the next.
constexpr base::Duration look_again = 10ms;
constexpr const char* program_commands =
    "another program commands the motors: end it first, or stop the robot";
/// In which a board answers.
constexpr base::Duration time_to_answer = 100ms;
/// Who looks later than that did not run, and has not heard what waits.
constexpr base::Duration most_late = 20ms;
/// What a board said so long ago still holds.
constexpr base::Duration longest_valid = 300ms;

/// Refusals take their time from here.
base::Time steady_now() {
  return base::Time{Clock::now().time_since_epoch()};
}

}  // namespace

Control::Control(transport::Bus& bus, const protocol::Catalogue& catalogue, Viewers& viewers, Sent sent,
                 Obstacle obstacle)
    : bus_(&bus),
      catalogue_(&catalogue),
      viewers_(&viewers),
      sent_(std::move(sent)),
      obstacle_(std::move(obstacle)),
      index_(catalogue),
      refusals_(catalogue),
      behaviour_(catalogue) {}

void Control::refuse(ViewerId viewer, std::string_view why) {
  viewers_->tell(viewer, foxglove::status(foxglove::Level::error, why));
}

std::string Control::why_not_taken() {
  const auto delivery = bus_->delivery();
  if (!delivery.obstruction.what.empty())
    return fmt::format("{}; {}", delivery.obstruction.what, delivery.obstruction.remedy);
  return fmt::format("the bus takes no frame: {}", why_none_leaves(*bus_));
}

bool Control::send(ViewerId viewer, const can::AnyFrame& frame) {
  if (handed_.empty()) left_ = Clock::now();
  const auto taken = bus_->send_any(frame);
  if (!taken || !*taken) return false;
  handed_.push_back({viewer, frame});
  look_what_left();
  return true;
}

void Control::look_what_left() {
  if (handed_.empty()) return;
  const auto delivery = bus_->delivery();
  const auto now = Clock::now();
  for (; handed_.size() > (delivery.known ? delivery.pending : 0); handed_.pop_front()) {
    const can::AnyFrame& frame = handed_.front().frame;
    if (const auto classic = frame.classic()) refusals_.sent(*classic, steady_now());
    sent_(frame);
    left_ = now;
    stuck_is_said_ = false;
  }
  if (!is_stuck() || std::exchange(stuck_is_said_, true)) return;
  std::set<ViewerId> viewers;
  for (const Handed& each : handed_) {
    const auto classic = each.frame.classic();
    // Who goes on driving hears of it when the next set point is kept back.
    if (!classic || is_rest(*classic) || commanded_motors(index_, *classic) == nullptr)
      viewers.insert(each.viewer);
  }
  for (const ViewerId viewer : viewers) refuse(viewer, what_is_stuck());
}

bool Control::is_stuck() const {
  return !handed_.empty() && Clock::now() - left_ >= client::longest_without_set_point;
}

std::string Control::what_is_stuck() const {
  return fmt::format("{} not left {}, and may leave later: {}",
                     handed_.size() == 1 ? "a frame has" : fmt::format("{} frames have", handed_.size()),
                     bus_->name(), why_none_leaves(*bus_));
}

void Control::send_all(ViewerId viewer, const Driver::Frames& frames) {
  for (const can::Frame& frame : frames) {
    if (is_rest(frame)) {
      rests_.push_back(frame);
      continue;
    }
    // No set point waits behind another: the robot does what is commanded now.
    const auto delivery = bus_->delivery();
    if (delivery.known && delivery.pending != 0) {
      withhold(viewer);
      continue;
    }
    withheld_.reset();
    if (!send(viewer, can::AnyFrame{frame})) refuse(viewer, why_not_taken());
  }
  while (!rests_.empty() && send(viewer, can::AnyFrame{rests_.front()})) rests_.pop_front();
}

void Control::withhold(ViewerId viewer) {
  const auto now = Clock::now();
  if (!withheld_) withheld_ = Withheld{now, false};
  if (withheld_->is_said || now - withheld_->since < client::longest_without_set_point) return;
  withheld_->is_said = true;
  refuse(viewer, fmt::format("no set point leaves {}: {}", bus_->name(), why_none_leaves(*bus_)));
}

void Control::drive(ViewerId viewer, const client::Hold& hold) {
  const std::uint32_t id = hold.frame.id;
  if (!is_rest(hold.frame) && !driver_.holds(id) && !driver_.must_rest(viewer, id)) {
    if (const std::string why = obstacle_(); !why.empty()) return refuse(viewer, why);
    if (other_heard_ && Clock::now() - other_ < client::listen_before_hold)
      return refuse(viewer, program_commands);
    if (behaviour_.exists()) return begin(viewer, hold);
  }
  if (is_rest(hold.frame) && waiting_ && (waiting_->viewer == viewer || waiting_->hold.frame.id == id))
    end_waiting(viewer);
  Driver::Frames frames;
  const std::string why = driver_.drive(viewer, hold, Clock::now(), frames);
  if (!why.empty()) refuse(viewer, why);
  send_all(viewer, frames);
}

void Control::begin(ViewerId viewer, const client::Hold& hold) {
  if (waiting_ && waiting_->viewer != viewer) return refuse(viewer, viewer_drives);
  const auto now = Clock::now();
  if (waiting_) {
    waiting_->hold = hold;
    return;
  }
  waiting_ = Waiting{viewer, hold, now + time_to_answer};
  if (said_ && now - *said_ < longest_valid) return begin_waiting();
  if (!send(viewer, can::AnyFrame{behaviour_.request()})) begin_waiting();  // which says why nothing is taken
}

void Control::begin_waiting() {
  const auto [viewer, hold, until] = *std::exchange(waiting_, std::nullopt);
  // A board that said so and does not answer now, as on a busy machine, may still do it.
  if (is_behaving_)
    return refuse(viewer, fmt::format("{} drives the wheels by itself: wait for its end, or stop the robot",
                                      catalogue_->board_name(behaviour_.topic())));
  Driver::Frames frames;
  const std::string why = driver_.drive(viewer, hold, Clock::now(), frames);
  if (!why.empty()) refuse(viewer, why);
  send_all(viewer, frames);
}

void Control::end_waiting(ViewerId by) {
  if (!waiting_) return;
  if (waiting_->viewer != by) driver_.end_early(waiting_->viewer, waiting_->hold.frame.id, Clock::now());
  waiting_.reset();
}

void Control::command(ViewerId viewer, const client::Command& command) {
  if (command.hold) return drive(viewer, *command.hold);
  if (command.ends_hold) {  // also where another drives
    end_waiting(0);
    Driver::Frames frames;
    driver_.rest(frames);
    send_all(viewer, frames);
  } else if (std::string why = obstacle_(); !why.empty()) {
    return refuse(viewer, why);
  } else if (is_stuck()) {  // what waits would leave when it is not wanted any more
    return refuse(viewer, what_is_stuck());
  } else if (why = why_not_begun(viewer, command); !why.empty()) {
    return refuse(viewer, why);
  }
  bool all = true;
  command.each_frame([&](const can::AnyFrame& frame) { all = send(viewer, frame) && all; });
  if (!all)
    refuse(viewer, why_not_taken());
  else if (is_stuck())  // a stop waits with the others
    refuse(viewer, what_is_stuck());
}

std::string Control::why_not_begun(ViewerId viewer, const client::Command& command) const {
  const bool begins = std::any_of(command.frames.begin(), command.frames.end(), [&](const can::Frame& frame) {
    return !is_rest(frame) && behaviour_.commanded(index_, frame) != nullptr;
  });
  if (!begins) return {};
  if (driver_.drives() && !driver_.drives(viewer)) return viewer_drives;
  if (other_heard_ && Clock::now() - other_ < client::listen_before_hold) return program_commands;
  return {};
}

void Control::rest_what_waits(ViewerId viewer, Driver::Frames& out) const {
  for (const Handed& each : handed_) {
    const auto classic = each.frame.classic();
    if ((viewer != 0 && each.viewer != viewer) || !classic || is_rest(*classic) ||
        behaviour_.commanded(index_, *classic) == nullptr)
      continue;
    can::Frame rest = *classic;
    rest.data = {};
    out.push_back(rest);
  }
}

void Control::look_whether_it_ran() {
  const auto now = Clock::now();
  if (driver_.drives() && now - looked_ >= client::longest_without_set_point) {
    Driver::Frames frames;
    driver_.end_all(now, frames);
    send_all(0, frames);
    refuse(0, fmt::format("serve did not run for {:.1f} s: the motors rest; release, then drive again",
                          std::chrono::duration<double>(now - looked_).count()));
  }
  looked_ = now;
}

void Control::carry_out(const Order& order) {
  look_whether_it_ran();
  switch (order.kind) {
    case Order::Kind::publish: {
      const auto parsed = command_of(*catalogue_, order.topic, order.payload);
      if (!parsed) return refuse(order.viewer, fmt::format("{}: {}", order.topic, parsed.error));
      return command(order.viewer, *parsed);
    }
    case Order::Kind::parameter: {
      const protocol::Topic* const sensor = sensor_of(*catalogue_, order.topic);
      if (sensor == nullptr) return;
      const auto parsed = period_command(*catalogue_, sensor->name, order.value);
      if (!parsed) return refuse(order.viewer, fmt::format("{}: {}", order.topic, parsed.error));
      return command(order.viewer, *parsed);
    }
    case Order::Kind::gone: {
      if (waiting_ && waiting_->viewer == order.viewer) waiting_.reset();
      Driver::Frames frames;
      driver_.gone(order.viewer, frames);
      rest_what_waits(order.viewer, frames);
      return send_all(order.viewer, frames);
    }
    case Order::Kind::playback:  // a bus is not wound
    case Order::Kind::newest:
    case Order::Kind::get_parameters:
    case Order::Kind::subscribe_parameters:
    case Order::Kind::unsubscribe_parameters:
    case Order::Kind::confirm_parameters:
      return;
  }
}

void Control::heard(const can::Received& received) {
  look_whether_it_ran();
  look_what_left();
  if (const auto refused = refusals_.take(received, steady_now()))
    refuse(0, fmt::format("{} refuses {}: {}; {}", refused->board, refused->topic->name, describe(*refused),
                          remedy(*refused)));
  if (const auto active = behaviour_.active_in(index_, received.frame)) {
    is_behaving_ = !active->empty();
    said_ = Clock::now();
    if (waiting_) begin_waiting();
  }
  if (commanded_motors(index_, received.frame) == nullptr) return;
  if (!is_rest(received.frame)) {
    other_ = Clock::now();
    other_heard_ = true;
  } else if (driver_.drives() || waiting_) {
    // It stopped the robot that a viewer drives, or is about to: the stop holds.
    end_waiting(0);
    Driver::Frames frames;
    driver_.rest(frames);
    send_all(0, frames);
    refuse(0, "another program has stopped the robot");
  }
}

void Control::advance() {
  look_whether_it_ran();
  look_what_left();
  if (const auto now = Clock::now(); waiting_ && now >= waiting_->until) {
    if (now - waiting_->until > most_late)
      waiting_->until = now + time_to_answer;
    else
      begin_waiting();
  }
  Driver::Frames frames;
  if (driver_.advance(Clock::now(), frames))
    refuse(0, "the page that drove was silent for half a second: the motors rest");
  send_all(0, frames);
}

std::optional<Clock::time_point> Control::next() const {
  auto next = driver_.next();
  if (waiting_) next = next ? std::min(*next, waiting_->until) : waiting_->until;
  if (!rests_.empty() || !handed_.empty()) {
    const auto again = Clock::now() + look_again;
    next = next ? std::min(*next, again) : again;
  }
  return next;
}

std::string Control::rest() {
  Driver::Frames frames;
  driver_.rest(frames);
  rest_what_waits(0, frames);
  send_all(0, frames);
  const auto late = Clock::now() + client::longest_without_set_point;
  const auto all_left = [this] { return rests_.empty() && handed_.empty(); };
  while (!all_left() && bus_->state() != transport::BusState::closed && Clock::now() < late) {
    sleep_for(look_again);
    send_all(0, {});
    look_what_left();
  }
  if (all_left()) return {};
  const bool moves =
      !rests_.empty() || std::any_of(handed_.begin(), handed_.end(), [this](const Handed& each) {
        const auto classic = each.frame.classic();
        return classic && (commanded_motors(index_, *classic) != nullptr ||
                           behaviour_.commanded(index_, *classic) != nullptr);
      });
  return fmt::format("serve: {} did not leave {}, and may leave later{}{}",
                     counted(rests_.size() + handed_.size(), "frame"), bus_->name(), moves ? "; " : "",
                     moves ? still_moving : "");
}

}  // namespace ocm::cli::serve
