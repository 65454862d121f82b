#include "cli/replay/player.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <poll.h>

#include "ocm/client/command.hpp"

#include "cli/output/printer.hpp"
#include "cli/shared/clock.hpp"
#include "cli/shared/filters.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/unhurried_messages.hpp"

namespace ocm::cli::replay {

namespace {

/// A signal that comes just before a wait is seen after so long at most.
constexpr base::Duration longest_wait = std::chrono::milliseconds{200};

}  // namespace

base::Time monotonic_now() {
  return base::Time{Clock::now().time_since_epoch()};
}

void wait_until(base::Time time) {
  while (interrupted() == 0) {
    const base::Time now = monotonic_now();
    if (now >= time) return;
    const base::Time step = std::min(time, now + longest_wait);
    sleep_until(Clock::time_point{step.time_since_epoch()});
  }
}

Selection::Selection(const protocol::Catalogue& catalogue, std::vector<const protocol::Topic*> topics,
                     Only only)
    : index_(catalogue),
      topics_(std::move(topics)),
      only_(only),
      has_packets_(std::any_of(topics_.begin(), topics_.end(),
                               [](const protocol::Topic* topic) { return goes_in_packets(*topic); })) {}

bool Selection::has(const log::Entry& entry, const log::Interfaces& interfaces) {
  if (topics_.empty() && only_ == Only::all) return true;
  if (has_packets_ && only_ != Only::commands && is_packet(entry)) return true;
  if (index_.has_buses()) index_.name(entry.interface, interfaces.name(entry.interface));
  const auto* topic = index_.of(entry.interface).subject(entry.id, entry.format).topic;
  if (entry.is_fd() && (topic == nullptr || !topic->is_message())) return false;
  if (topic == nullptr || !topic->is_message()) {
    if (entry.format != can::Format::base) return false;
    const bool command = protocol::Identifier::decode(entry.id).direction == protocol::Direction::command;
    if (only_ != Only::all && command != (only_ == Only::commands)) return false;
  } else if (only_ == Only::commands) {
    return false;
  }
  return topics_.empty() || std::find(topics_.begin(), topics_.end(), topic) != topics_.end();
}

Player::Player(PlayerOptions options, Selection selection, std::vector<Outlet> outlets,
               std::unique_ptr<log::Writer> printer)
    : options_(std::move(options)),
      selection_(std::move(selection)),
      outlets_(std::move(outlets)),
      printer_(std::move(printer)),
      playback_(options_.playback) {}

void Player::play(log::Reader& log) {
  first_.reset();
  routes_.clear();
  std::array<log::Entry, log::batch> entries;
  bool goes_on = true;
  while (goes_on) {
    const std::size_t count = log.read(entries);
    if (count == 0) {
      cut_short_ = interrupted() != 0;  // while the last frame waited
      return;
    }
    for (std::size_t i = 0; i < count && goes_on; ++i)
      goes_on = interrupted() == 0 && play(entries[i], log.interfaces());
    write_out(printed_);
  }
  cut_short_ = true;
}

bool Player::play(const log::Entry& entry, const log::Interfaces& interfaces) {
  if (!first_) {
    first_ = entry.time;
    if (!started_) begin_ = printer_ != nullptr ? base::Time{} : monotonic_now();
    playback_.begin(started_ ? playback_.last_due() : begin_,
                    log::Playback::later(entry.time, options_.span.from));
    started_ = true;
  }
  const base::Duration offset = log::Playback::distance(entry.time, *first_);
  if (options_.span.is_behind(offset)) return false;
  if (options_.span.is_before(offset) || !selection_.has(entry, interfaces)) {
    ++played_.not_chosen;
    return true;
  }
  if (printer_ != nullptr)
    print(entry, interfaces);
  else
    return send(entry, interfaces);
  return true;
}

bool Player::send(const log::Entry& entry, const log::Interfaces& interfaces) {
  const auto outlet = route(entry.interface, interfaces);
  if (!outlet) {
    ++played_.no_route;
    return true;
  }
  for (Outlet& each : outlets_) each.expect_motion_left();  // also where frames leave no time between them
  auto& bus = outlets_[*outlet];
  if (options_.at_once) {
    count(bus.send(entry, base::never));
    return true;
  }
  const base::Time due = playback_.due(entry.time);
  watch_until(due - std::chrono::milliseconds{2});
  wait_until(due);  // to the microsecond
  if (interrupted() != 0) return true;
  playback_.sent(due, monotonic_now());
  if (!keep_up(entry, due)) return false;
  // The bus may take its time before it takes a set point, too.
  const base::Time planned = playback_.last_due();
  auto sent = bus.send(entry, planned + lateness_ + client::longest_without_set_point);
  if (sent == Outlet::Sent::late) {
    if (!keep_up(entry, planned)) return false;
    sent = bus.send(entry, base::never);
  }
  count(sent);
  return true;
}

bool Player::keep_up(const log::Entry& entry, base::Time due) {
  const base::Time now = monotonic_now();
  const base::Duration later = now - due - lateness_;
  const bool held_up = later >= client::longest_without_set_point;
  if (now - due < client::longest_without_set_point) {
    lateness_ = now - due;
    return true;
  }
  if (held_up &&
      std::any_of(outlets_.begin(), outlets_.end(), [](const Outlet& each) { return each.commands(); })) {
    held_up_ = later;
    return false;
  }
  playback_.begin(now, entry.time);
  lateness_ = {};
  return true;
}

void Player::count(Outlet::Sent sent) {
  switch (sent) {
    case Outlet::Sent::yes:
      ++played_.sent;
      return;
    case Outlet::Sent::error_frame:
      ++played_.error_frames;
      return;
    case Outlet::Sent::fd_frame:
      ++played_.fd_frames;
      return;
    case Outlet::Sent::late:  // not without a latest time
      return;
  }
}

void Player::watch_until(base::Time time) {
  std::vector<pollfd> buses;
  while (interrupted() == 0) {
    const base::Time now = monotonic_now();
    if (now >= time) return;
    UnhurriedMessages::write();
    buses.clear();
    for (Outlet& outlet : outlets_) {
      outlet.expect_open();
      outlet.expect_motion_left();
      buses.push_back({outlet.descriptor(), POLLIN, 0});
    }
    static_cast<void>(wait_for_input(buses, std::min(time - now, longest_wait)));
  }
}

void Player::print(const log::Entry& entry, const log::Interfaces& interfaces) {
  if (!route(entry.interface, interfaces)) {
    ++played_.no_route;
    return;
  }
  if (entry.format == can::Format::error) {
    ++played_.error_frames;
    return;
  }
  log::Entry printed = entry;
  printed.time = options_.at_once ? base::Time{} : playback_.due(entry.time);
  printer_->write(printed_, {&printed, 1}, interfaces);
  ++played_.sent;
}

std::optional<std::size_t> Player::route(std::uint16_t interface, const log::Interfaces& interfaces) {
  if (options_.routes.empty()) return 0;
  while (routes_.size() <= interface) {
    const auto name = interfaces.name(static_cast<std::uint16_t>(routes_.size()));
    const auto found = std::find_if(options_.routes.begin(), options_.routes.end(),
                                    [name](const auto& known) { return known.first == name; });
    routes_.push_back(found != options_.routes.end() ? std::optional{found->second} : std::nullopt);
  }
  return routes_[interface];
}

base::Duration Player::lasted() const {
  return started_ ? monotonic_now() - begin_ : base::Duration{};
}

}  // namespace ocm::cli::replay
