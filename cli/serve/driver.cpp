#include "cli/serve/driver.hpp"

#include <algorithm>
#include <utility>

namespace ocm::cli::serve {

std::string Driver::drive(ViewerId viewer, const client::Hold& hold, Clock::time_point now, Frames& out) {
  const bool is_rest = hold.frame.data == hold.rest.data;
  const auto held = std::find_if(held_.begin(), held_.end(),
                                 [&](const Held& each) { return each.hold.frame.id == hold.frame.id; });
  const std::uint32_t id = hold.frame.id;
  const auto is_its_own = [&](const Ended& each) { return each.viewer == viewer && each.id == id; };
  if (is_rest) {  // from any viewer: a stop is not refused
    out.push_back(hold.rest);
    if (held != held_.end()) {
      if (held->viewer != viewer) end(*held);
      held_.erase(held);
    }
    std::erase_if(ended_, is_its_own);
    if (!says_rest(viewer)) say_rest_.push_back(viewer);
    return {};
  }
  if (const auto ended = std::find_if(ended_.begin(), ended_.end(), is_its_own); ended != ended_.end()) {
    const bool was_silent = now - std::exchange(ended->heard, now) >= patience;
    if (says_rest(viewer) || !was_silent)
      return std::exchange(ended->told, true) ? "" : "the drive was ended: release first, then drive again";
    ended_.erase(ended);
  }
  if (held != held_.end() && held->viewer != viewer) return viewer_drives;
  if (held == held_.end()) {
    out.push_back(hold.frame);
    held_.push_back({viewer, hold, now, now + client::hold_period});
    return {};
  }
  held->heard = now;
  // A page says the same many times a second: what it said is on the bus already, and is repeated in time.
  if (held->hold.frame.data != hold.frame.data) {
    out.push_back(hold.frame);
    held->next = now + client::hold_period;
  }
  held->hold = hold;
  return {};
}

void Driver::gone(ViewerId viewer, Frames& out) {
  std::erase_if(held_, [&](const Held& each) {
    if (each.viewer == viewer) out.push_back(each.hold.rest);
    return each.viewer == viewer;
  });
  std::erase(say_rest_, viewer);
  std::erase_if(ended_, [viewer](const Ended& each) { return each.viewer == viewer; });
}

bool Driver::must_rest(ViewerId viewer, std::uint32_t id) const noexcept {
  return std::any_of(ended_.begin(), ended_.end(),
                     [&](const Ended& each) { return each.viewer == viewer && each.id == id; });
}

bool Driver::says_rest(ViewerId viewer) const noexcept {
  return std::find(say_rest_.begin(), say_rest_.end(), viewer) != say_rest_.end();
}

void Driver::end(const Held& held) {
  ended_.push_back({held.viewer, held.hold.frame.id, held.heard});
}

void Driver::rest(Frames& out) {
  for (const Held& each : held_) {
    out.push_back(each.hold.rest);
    end(each);
  }
  held_.clear();
}

void Driver::end_all(Clock::time_point now, Frames& out) {
  for (Held& each : held_) each.heard = now;
  rest(out);
}

bool Driver::drives(ViewerId viewer) const noexcept {
  return std::any_of(held_.begin(), held_.end(),
                     [viewer](const Held& each) { return each.viewer == viewer; });
}

bool Driver::advance(Clock::time_point now, Frames& out) {
  const std::size_t before = held_.size();
  std::erase_if(held_, [&](Held& each) {
    if (now - each.heard >= patience) {
      out.push_back(each.hold.rest);
      end(each);
      return true;
    }
    if (now >= each.next) {
      out.push_back(each.hold.frame);
      each.next = now + client::hold_period;
    }
    return false;
  });
  return held_.size() != before;
}

std::optional<Clock::time_point> Driver::next() const {
  std::optional<Clock::time_point> next;
  for (const Held& each : held_) {
    const auto due = std::min(each.next, each.heard + patience);
    next = next ? std::min(*next, due) : due;
  }
  return next;
}

bool Driver::holds(std::uint32_t id) const noexcept {
  return std::any_of(held_.begin(), held_.end(), [id](const Held& each) { return each.hold.frame.id == id; });
}

}  // namespace ocm::cli::serve
