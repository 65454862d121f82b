#include "cli/command/broadcasts.hpp"

#include <algorithm>

#include "ocm/j1939/broadcast.hpp"
#include "ocm/j1939/identifier.hpp"

#include "cli/shared/clock.hpp"

namespace ocm::cli {
namespace {

std::uint8_t source_of(const client::Broadcast& broadcast) {
  return j1939::Identifier::decode(broadcast.id()).source;
}

}  // namespace

void Broadcasts::begin(client::Broadcast broadcast, const std::optional<client::Repeat>& repeat, Moment now) {
  std::erase_if(all_, [&](const Each& each) {
    if (each.broadcast.id() != broadcast.id() || each.at != 0) return false;
    if (each.period.count() == 0 && each.begin < each.end) ++counts_.waited;
    return true;
  });
  for (Each& each : all_)
    if (each.broadcast.id() == broadcast.id()) each.period = {}, each.begin = each.end = now;
  Each each{std::move(broadcast), {}, now + Clock::duration{1}, now, now, now, 0, false, {}};
  if (repeat) {
    each.period = repeat->period;
    each.end = repeat->lasting.count() > 0 ? time_after(now, repeat->lasting) : Moment::max();
  }
  all_.push_back(std::move(each));
}

Broadcasts::Moment Broadcasts::due(const Each& each) const noexcept {
  if (each.at != 0) return each.next;
  const std::uint8_t source = source_of(each.broadcast);
  const bool busy = std::any_of(all_.begin(), all_.end(), [source](const Each& other) {
    return other.at != 0 && source_of(other.broadcast) == source;
  });
  return busy ? Moment::max() : std::max(each.next, free_[source]);  // the other's end comes first
}

Broadcasts::Moment Broadcasts::next_event() const noexcept {
  Moment next = Moment::max();
  for (const Each& each : all_)
    next = std::min(next, each.at == 0 && each.begin >= each.end ? each.end : due(each));
  return next;
}

bool Broadcasts::is_over(const Each& each, Moment now) const noexcept {
  return each.at == 0 && each.begin >= each.end && now >= each.end;
}

bool Broadcasts::is_due(Each& each, Moment now) {
  if (each.at == 0 && each.begin >= each.end) return false;
  if (now < due(each)) return false;
  if (each.at == 0) {
    skip_missed_turns(each, now);
    return each.begin < each.end;
  }
  if (now - each.left <= j1939::timeout::t1) return true;
  give_up_round(each, now);
  return each.begin < each.end && now >= due(each);  // unless another has taken its place
}

void Broadcasts::give_up_round(Each& each, Moment now) {
  each.at = 0;
  // It begins again, or is the first of the turns that are left out.
  const std::uint64_t over = each.period.count() == 0 ? 0 : leave_out(each, now);
  counts_.late += std::max<std::uint64_t>(over, 1);
}

void Broadcasts::skip_missed_turns(Each& each, Moment now) {
  if (each.period.count() == 0 || each.held_up) return;
  const std::uint8_t source = source_of(each.broadcast);
  // Where its own round was the last of the source, no other message has made it wait.
  const bool alone = free_[source] == each.left + j1939::broadcast_distance;
  const Moment since = alone ? each.next : due(each);
  const auto late = static_cast<std::uint64_t>((now - since) / each.period);
  const std::uint64_t over = leave_out(each, now);
  counts_.late += std::min(over, late);
  counts_.waited += over - std::min(over, late);
}

std::uint64_t Broadcasts::leave_out(Each& each, Moment now) {
  if (each.begin >= each.end || now < each.begin) return 0;
  const auto over = (now - each.begin) / each.period;
  const auto planned = (each.end - each.begin - Clock::duration{1}) / each.period + 1;
  each.begin += over * each.period;
  return static_cast<std::uint64_t>(std::min(over, planned));
}

void Broadcasts::sent(Each& each, Moment taken) {
  const std::uint32_t frames = each.broadcast.frames();
  if (each.at == 0) each.met = false;
  each.left = taken;
  each.held_up.reset();
  each.next = taken + j1939::broadcast_distance;
  free_[source_of(each.broadcast)] = each.next;
  if (++each.at != frames) return;
  each.at = 0;
  if (each.period.count() == 0) {
    each.begin = each.end = std::min(each.end, taken);
    return;
  }
  each.begin += each.period;  // absolute: no drift
  each.next = each.begin;
}

void Broadcasts::hold_up(Each& each, Moment now) {
  each.next = now + try_again;
  if (!each.held_up) each.held_up = now;
}

const client::Broadcast* Broadcasts::meet(const can::Frame& frame) {
  if (frame.format != can::Format::extended) return nullptr;
  const auto id = j1939::Identifier::decode(frame.id);
  const bool is_broadcast = id.pgn == j1939::connection_group || id.pgn == j1939::transfer_group;
  if (!is_broadcast || id.destination != j1939::global_address) return nullptr;
  for (Each& each : all_) {
    if (each.at == 0 || each.met || source_of(each.broadcast) != id.source) continue;
    each.met = true;
    ++counts_.met;
    return &each.broadcast;
  }
  return nullptr;
}

std::optional<Broadcasts::Moment> Broadcasts::held_up_since() const noexcept {
  std::optional<Moment> since;
  for (const Each& each : all_)
    if (each.held_up && (!since || *each.held_up < *since)) since = each.held_up;
  return since;
}

const client::Broadcast* Broadcasts::unfinished() const noexcept {
  for (const Each& each : all_)
    if (each.at != 0) return &each.broadcast;
  return nullptr;
}

std::vector<const client::Broadcast*> Broadcasts::waiting() const {
  std::vector<const client::Broadcast*> out;
  for (const Each& each : all_)
    if (each.at == 0 && each.period.count() == 0 && each.begin < each.end) out.push_back(&each.broadcast);
  return out;
}

}  // namespace ocm::cli
