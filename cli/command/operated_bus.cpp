#include "cli/command/operated_bus.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

#include <fmt/format.h>

#include "ocm/can/text.hpp"

#include "cli/shared/messages.hpp"
#include "cli/shared/set_points.hpp"

namespace ocm::cli {
namespace {

/// A frame that the operator has taken is on the bus by then, or never.
constexpr base::Duration longest_echo{2'000'000'000};

}  // namespace

OperatedBus::OperatedBus(std::unique_ptr<transport::Bus> bus, std::unique_ptr<OperatorLink> link,
                         const protocol::Catalogue& catalogue, std::string verb)
    : bus_(std::move(bus)), link_(std::move(link)), index_(catalogue), verb_(std::move(verb)) {}

bool OperatedBus::commands(const can::Frame& frame) const {
  if (frame.format != can::Format::base) return false;
  const auto found = index_.subject(frame.id, frame.format);
  return found.frame && !found.topic->is_message() && found.topic->kind == protocol::Kind::actuator;
}

base::Result<bool> OperatedBus::send(const can::Frame& frame) {
  if (!commands(frame)) return bus_->send(frame);
  const auto answer = link_->ask(fmt::format("send {}", can::to_text(frame).view()));
  refused_ = answer.kind == OperatorAnswer::Kind::no;
  obstacle_ = answer.failure;
  switch (answer.kind) {
    case OperatorAnswer::Kind::silent:
      // Rest does no harm, and must reach the robot.
      if (!ends_motion(*index_.subject(frame.id, frame.format).topic, frame)) return false;
      past_it_ = true;
      return bus_->send(frame);
    case OperatorAnswer::Kind::no:
    case OperatorAnswer::Kind::wait:
      return false;
    case OperatorAnswer::Kind::ok:
      break;
  }
  const std::string_view text = answer.text;
  const auto line = text.find('\n');
  const auto sent = can::parse_frame(text.substr(0, line));
  forget_old_echoes();  // who only sends receives none
  echoes_.push_back({sent ? *sent : frame, Clock::now() + longest_echo});
  tell_limits(line == std::string_view::npos ? std::string_view{} : text.substr(line + 1));
  ++passed_on_;
  return true;
}

base::Result<bool> OperatedBus::send_any(const can::AnyFrame& frame) {
  if (const auto classic = frame.classic()) return send(*classic);
  return bus_->send_any(frame);
}

void OperatedBus::tell_limits(std::string_view lines) {
  std::string unheard;
  while (!lines.empty()) {
    const std::string_view limit = lines.substr(0, lines.find('\n'));
    lines.remove_prefix(std::min(limit.size() + 1, lines.size()));
    if (!told_limits_.emplace(limit).second) continue;
    unheard += unheard.empty() ? "" : ", ";
    unheard += limit;
  }
  if (!unheard.empty()) remark(fmt::format("{}: {} limits {}", verb_, link_->who(), unheard));
}

void OperatedBus::forget_old_echoes() {
  const auto now = Clock::now();
  while (!echoes_.empty() && echoes_.front().until < now) echoes_.pop_front();
}

bool OperatedBus::is_echo(const can::Frame& frame) {
  forget_old_echoes();
  const auto found =
      std::find_if(echoes_.begin(), echoes_.end(), [&](const Echo& echo) { return echo.frame == frame; });
  if (found == echoes_.end()) return false;
  echoes_.erase(found);
  return true;
}

base::Result<can::Received> OperatedBus::receive(base::Duration timeout) {
  for (;;) {
    const auto received = bus_->receive(timeout);
    if (!received || !is_echo(received->frame)) return received;
    timeout = base::Duration{0};
  }
}

base::Result<transport::ReceivedAny> OperatedBus::receive_any(base::Duration timeout) {
  for (;;) {
    const auto received = bus_->receive_any(timeout);
    if (!received) return received;
    const auto classic = received->frame.classic();
    if (!classic || !is_echo(*classic)) return received;
    timeout = base::Duration{0};
  }
}

const transport::BusCounters& OperatedBus::counters() const {
  counters_ = bus_->counters();
  counters_.sent += passed_on_;
  return counters_;
}

transport::Delivery OperatedBus::delivery() {
  auto delivery = bus_->delivery();
  if (past_it_) return delivery;
  if (!obstacle_.what.empty()) {
    delivery.obstruction = obstacle_;
    delivery.refused = refused_;
    return delivery;
  }
  if (passed_on_ == 0) return delivery;
  const auto answer = link_->ask("delivery");
  if (answer.kind != OperatorAnswer::Kind::ok) {
    delivery.obstruction = answer.failure;
    return delivery;
  }
  std::uint64_t pending = 0;
  const char* const end = answer.text.data() + answer.text.size();
  if (std::from_chars(answer.text.data(), end, pending).ec != std::errc{}) return delivery;  // it cannot tell
  delivery.known = true;
  delivery.pending += pending;
  return delivery;
}

Guarded::Own OperatedBus::commands_itself(const can::Frame& frame) {
  const auto answer = link_->ask(fmt::format("{}{}", operator_commands, can::to_text(frame).view()));
  if (answer.kind != OperatorAnswer::Kind::ok || answer.text.empty()) return {};
  const std::string_view text = answer.text;
  const auto line = text.find('\n');
  return {link_->who(), std::string{text.substr(line == std::string_view::npos ? text.size() : line + 1)},
          text.substr(0, line) == operator_repeats};
}

}  // namespace ocm::cli
