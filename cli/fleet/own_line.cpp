#include "cli/fleet/own_line.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <poll.h>
#include <utility>

#include <fmt/format.h>

#include "cli/fleet/line_time.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli::fleet {
namespace {

using namespace std::chrono_literals;
using mapper::server::CentralEvent;

/// Read from the dongle between two looks at the other programs: many times what a serial line brings
/// meanwhile, and little where a device never stops.
constexpr std::size_t most_heard = 16'384;
constexpr base::Duration renewal_interval = 1s;

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

OwnLine::OwnLine(std::string_view verb, Dongle dongle, const cognitive::FleetOptions& fleet,
                 std::unique_ptr<LocalServer> service)
    : verb_(verb),
      dongle_(dongle.dialect),
      server_(fleet),
      owner_(verb_, server_, std::move(service)),
      port_(std::move(dongle.port)),
      orders_(cognitive::Fleet::most_robots) {
  dongle_.from_dongle(dongle.heard, line_time());
}

OwnLine::~OwnLine() {
  // Who listens, and what draws, may be gone already, and others still ask while the line is served below.
  heard_ = nullptr;
  owner_.end_drawing();
  try {
    if (port_) finish();
    server_.expire(line_time());
    server_.client().leave();
    flush(1s);
  } catch (const Exit&) {  // the line is gone, which is said
  }
}

void OwnLine::finish() {
  const auto at_work = [this] { return owner_.at_work(line_time()); };
  owner_.close();
  if (interrupted() == 0 && !at_work().empty()) {
    (void)std::fflush(stdout);  // what is asked for is done
    remark(fmt::format("{}: done; it serves the central's line until {} has ended (Ctrl-C stops its robots)",
                       verb_, joined(at_work())));
    while (interrupted() == 0 && !at_work().empty()) exchange();
  }
  (void)halt(*this, verb_, owner_.driven_by_others(), [](unsigned) { return true; });
}

void OwnLine::flush(base::Duration limit) {
  // After a stop of this program the limit is over, and the dongle has had no time.
  constexpr int fewest = 20;
  const base::Time end = line_time() + limit;
  server_.expire(line_time());
  const auto rest = [this] {
    return !server_.client().idle() || !dongle_.idle() || !unsent_.empty() || port_.unsent() != 0;
  };
  for (int looks = 0; port_ && (line_time() < end || looks < fewest) && rest(); ++looks) exchange();
}

void OwnLine::write() {
  dongle_.from_client(server_.take(), line_time());
  unsent_ += dongle_.take_for_dongle();
  if (unsent_.empty()) return;
  const auto taken = port_.write(unsent_);
  if (!taken) {
    auto failure = port_.failure();
    port_.close();
    fail({fmt::format("{}: {}", verb_, failure.what), failure.remedy});
  }
  unsent_.erase(0, *taken);
}

void OwnLine::exchange() {
  server_.expire(line_time());
  write();
  std::array<pollfd, 2> ends{{{port_.descriptor(), POLLIN, 0}, {owner_.descriptor(), POLLIN, 0}}};
  if (!unsent_.empty()) ends[0].events |= POLLOUT;
  const auto until = std::clamp<base::Duration>(server_.deadline() - line_time(), 1ms, 50ms);
  (void)::poll(ends.data(), ends.size(), static_cast<int>(until / 1ms));
  hear();
  dongle_.expire(line_time());
  const std::string said = dongle_.take_for_client();
  if (log_) log_->write(said);
  server_.feed(said, line_time(), [this](std::size_t robot, mapper::link::Kind kind) {
    if (heard_) heard_(robot, kind);
  });
  while (auto event = server_.next_event()) {
    if (event->kind != CentralEvent::Kind::failed) continue;
    owner_.failed(event->words);
    failed_.push_back(std::move(event->words));
  }
  owner_.serve(line_time());
  renew_service();
  write();
  UnhurriedMessages::write();
}

void OwnLine::hear() {
  std::array<char, 4096> room;
  for (std::size_t heard = 0; heard < most_heard;) {
    const auto size = port_.read(room);
    if (!size) {
      auto failure = port_.failure();
      port_.close();
      fail({fmt::format("{}: {}", verb_, failure.what), failure.remedy});
    }
    if (*size == 0) return;
    heard += *size;
    dongle_.from_dongle({room.data(), *size}, line_time());
  }
}

void OwnLine::renew_service() {
  if (line_time() < next_renewal_) return;
  next_renewal_ = line_time() + renewal_interval;
  const auto renewed = owner_.renew();
  if (!renewed && !is_unreachable_)
    remark(fmt::format("{}: the socket for other programs was removed: {}", verb_, renewed.error.what));
  if (renewed && *renewed)
    remark(fmt::format("{}: the socket for other programs was removed, and is there again", verb_));
  is_unreachable_ = !renewed;
}

LineEnd::Refused OwnLine::go(unsigned robot, const mapper::link::SetPoint& to) {
  auto refused = owner_.go(robot, to, line_time());
  if (!refused) orders_[robot] = owner_.robot(robot).order;
  return refused;
}
LineEnd::Refused OwnLine::calibrate(unsigned robot, bool only_ask) {
  auto refused = owner_.calibrate(robot, only_ask, line_time());
  if (!refused) orders_[robot] = owner_.robot(robot).order;
  return refused;
}
void OwnLine::pause(unsigned robot) {
  (void)server_.fleet().pause(robot, line_time());
}
void OwnLine::unpause(unsigned robot) {
  (void)server_.fleet().unpause(robot, line_time());
}
void OwnLine::ask_who(unsigned robot) {
  (void)server_.fleet().ask_who(robot, line_time());
}
bool OwnLine::is_ours(unsigned robot) const {
  return owner_.robot(robot).order == orders_[robot];
}

}  // namespace ocm::cli::fleet
