#include "cli/fleet/central_line.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <poll.h>
#include <utility>

#include <fmt/format.h>

#include "ocm/transport/pty.hpp"
#include "ocm/transport/virtual_bus.hpp"

#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/values.hpp"

namespace ocm::cli::fleet {
namespace {

using namespace std::chrono_literals;
using mapper::server::CentralEvent;
using mapper::server::Peer;

/// How long a robot may take from its link to its first word: it measures its gyro first.
constexpr base::Duration first_word = 8s;
/// And one of which pieces come: a handshake is two packets, and at 60 % loss whole every sixth time.
constexpr base::Duration first_whole_word = 40s;
/// How long a request may take at the central, with all its time-outs.
constexpr base::Duration request_timeout = 60s;

/// "AVR (index 0, address C00000000000), ...": those of this name, or all.
std::string listed(const std::vector<Peer>& peers, std::string_view name = {}) {
  std::string text;
  for (const Peer& peer : peers)
    if (name.empty() || peer.name == name)
      text += fmt::format("{}{} (index {}, address {})", text.empty() ? "" : ", ", peer.name, peer.index,
                          peer.address);
  return text;
}

}  // namespace

void add_line_options(Verb verb, LineOptions& options) {
  verb.add_option("--central", options.path,
                  "the central's serial line; default: that of `sim --robots` or `central --pty`")
      .type_name("PATH");
  add_dongle_options(verb, options.dongle);
  add_duration(verb, "--scan", options.scan, "how long to look for robots that are not listed");
}

Dongle CentralLine::open_line(std::string_view verb, const LineOptions& options) {
  catch_interrupts();
  const bool usual = options.path.empty();
  if (!usual) return open_dongle(verb, options.path, options.dongle);
  // The link that a killed simulator has left may lead to a terminal of another user.
  const std::string path = transport::central_line();
  if (!transport::is_served(path))
    fail(
        {fmt::format(
             "{}: there is no central at '{}'{}", verb, path,
             transport::VirtualBus::running() ? "; the simulator that runs is an AMiRo, which has none" : ""),
         "start one (amiroctl sim --robots 2, or amiroctl central --pty), or name a dongle: --central "
         "/dev/ttyACM0"});
  DongleOptions ours = options.dongle;
  ours.kind = "ours";
  return open_dongle(verb, path, ours);
}

CentralLine::CentralLine(std::string_view verb, const LineOptions& options,
                         const cognitive::FleetOptions& fleet, Dongle dongle)
    : verb_(verb),
      scan_(options.scan),
      port_(std::move(dongle.port)),
      dongle_(dongle.dialect),
      server_(fleet) {
  dongle_.from_dongle(dongle.heard, now());
  catch_interrupts();
  catch_hangups();
}

CentralLine::~CentralLine() {
  heard_ = nullptr;  // the listener may be gone already
  try {
    server_.expire(now());
    server_.client().leave();
    flush(1s);
  } catch (const Exit&) {  // the line is gone, which is said
  }
}

void CentralLine::flush(base::Duration limit) {
  const base::Time end = now() + limit;
  server_.expire(now());
  const auto rest = [this] {
    return !server_.client().idle() || !dongle_.idle() || !unsent_.empty() || port_.unsent() != 0;
  };
  while (port_ && now() < end && rest()) exchange();
}

bool CentralLine::halt(const std::vector<unsigned>& robots) {
  constexpr base::Duration any_leg = 20s;
  const auto drives = [this](unsigned index) {
    using mapper::server::Progress;
    const Progress progress = fleet().sender(index).progress();
    // Without a link it stops by itself.
    return fleet().robot(index).linked && progress != Progress::none && progress != Progress::stopped &&
           !fleet().sender(index).standing();
  };
  for (const unsigned index : robots)
    if (drives(index)) (void)server_.fleet().stop(index, now());
  const base::Time end = now() + any_leg;
  const int signals = interruptions();
  const auto any = [&] { return std::any_of(robots.begin(), robots.end(), drives); };
  while (any() && now() < end && interruptions() == signals) exchange();
  for (const unsigned index : robots)
    if (drives(index))
      remark(fmt::format(
          "{}: {} may still drive: nothing shows that it has heard the stop, which was said {} "
          "times; its leg ends after {} cm",
          verb_, name(index), fleet().sender(index).times_said(), mapper::server::longest_leg_cm));
  return !any();
}

base::Time CentralLine::now() {
  return base::Time{std::chrono::steady_clock::now().time_since_epoch()};
}

std::string CentralLine::name(unsigned index) const {
  const Peer* const peer = server_.client().peer(index);
  return peer != nullptr ? peer->name : fmt::format("robot {}", index);
}

void CentralLine::write() {
  dongle_.from_client(server_.take(), now());
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

void CentralLine::exchange() {
  server_.expire(now());
  write();
  pollfd line{port_.descriptor(), static_cast<short>(unsent_.empty() ? POLLIN : POLLIN | POLLOUT), 0};
  const auto until = std::clamp<base::Duration>(server_.deadline() - now(), 1ms, 50ms);
  (void)::poll(&line, 1, static_cast<int>(until / 1ms));
  std::array<char, 4096> room;
  for (;;) {
    const auto size = port_.read(room);
    if (!size) {
      auto failure = port_.failure();
      port_.close();
      fail({fmt::format("{}: {}", verb_, failure.what), failure.remedy});
    }
    if (*size == 0) break;
    dongle_.from_dongle({room.data(), *size}, now());
  }
  dongle_.expire(now());
  server_.feed(dongle_.take_for_client(), now(), [this](std::size_t robot, mapper::link::Kind kind) {
    if (heard_) heard_(robot, kind);
  });
  take_events();
  write();
}

void CentralLine::take_events() {
  while (auto event = server_.next_event())
    if (event->kind == CentralEvent::Kind::failed) failed_.push_back(std::move(*event));
}

bool CentralLine::run(std::optional<base::Duration> limit, const std::function<bool()>& done) {
  const base::Time begin = now();
  while (interrupted() == 0) {
    if (done()) return true;
    if (limit && now() - begin >= *limit) return false;
    exchange();
  }
  return false;
}

bool CentralLine::wait(base::Duration limit, const std::function<bool()>& done) {
  const bool was_done = run(limit, done);
  if (interrupted() != 0) throw Exit{exit_code_after_interrupt(exit_failure)};
  return was_done;
}

void CentralLine::list(base::Duration scan) {
  failed_.clear();
  server_.client().scan(scan);
  (void)wait(request_timeout, [this] { return server_.client().idle(); });
  if (!failed_.empty())
    fail({fmt::format("{}: {}: {}", verb_, path(), failed_.front().words),
          "is it a central? Unplug the dongle and plug it in again, or restart the simulation"});
}

const std::vector<Peer>& CentralLine::scan() {
  list(scan_);
  return server_.client().peers();
}

std::optional<unsigned> CentralLine::find(const std::string& name) const {
  const auto& peers = server_.client().peers();
  const auto count = std::count_if(peers.begin(), peers.end(), [&](const Peer& p) { return p.name == name; });
  if (count > 1)
    fail({fmt::format("{}: {} robots are called '{}'", verb_, count, name),
          fmt::format("name one by its index or address: {}", listed(peers, name))},
         exit_usage);
  for (const Peer& peer : peers)
    if (peer.name == name || peer.address == name) return peer.index;
  for (const Peer& peer : peers)
    if (std::to_string(peer.index) == name) return peer.index;
  return std::nullopt;
}

void CentralLine::unknown(const std::string& name) const {
  const auto& peers = server_.client().peers();
  fail({fmt::format("{}: the central finds no robot '{}'", verb_, name),
        peers.empty() ? "it finds none at all: is the robot switched on, and near?"
                      : fmt::format("it finds {}", listed(peers))});
}

std::vector<unsigned> CentralLine::connect(const std::vector<std::string>& names) {
  const bool all = names.empty() || std::find(names.begin(), names.end(), "all") != names.end();
  list(0s);
  if (all || std::any_of(names.begin(), names.end(), [this](const auto& name) { return !find(name); }))
    list(scan_);
  std::vector<unsigned> wanted;
  if (all)
    for (const Peer& peer : server_.client().peers()) wanted.push_back(peer.index);
  if (!all)
    for (const std::string& name : names) {
      const auto index = find(name);
      if (!index) unknown(name);
      if (std::find(wanted.begin(), wanted.end(), *index) == wanted.end()) wanted.push_back(*index);
    }
  if (wanted.empty())
    fail({fmt::format("{}: the central finds no robot", verb_),
          "is one switched on, and near? --scan 10s looks for longer"});
  failed_.clear();
  for (const unsigned index : wanted) server_.client().connect(index);
  (void)wait(request_timeout, [this] { return server_.client().idle(); });
  for (const CentralEvent& event : failed_) {
    if (wanted.size() == 1)
      fail({fmt::format("{}: {}", verb_, event.words), "is it near enough? `amiroctl robots` lists robots"});
    remark(fmt::format("{}: {}", verb_, event.words));
  }
  std::erase_if(wanted, [this](unsigned index) { return !fleet().robot(index).linked; });
  if (wanted.empty()) fail({fmt::format("{}: no robot could be connected", verb_), "are they near enough?"});
  const base::Time begin = now();
  (void)wait(first_whole_word, [&] {
    return std::all_of(wanted.begin(), wanted.end(), [&](unsigned index) {
      const bool pieces = fleet().ear(index).text().faults().total() != 0;
      return fleet().robot(index).last != mapper::link::Kind::none ||
             (!pieces && now() - begin >= first_word);
    });
  });
  return wanted;
}

void CentralLine::introduce(const std::vector<unsigned>& robots) {
  constexpr base::Duration again = 500ms;
  constexpr int times = 6;  // a handshake is two packets: at 30 % loss one of six comes whole in 98 of 100
  const auto strange = [this](unsigned index) {
    const cognitive::Robot& robot = fleet().robot(index);
    return robot.linked && robot.last != mapper::link::Kind::none && !robot.handshake;
  };
  for (int time = 0; time < times && std::any_of(robots.begin(), robots.end(), strange); ++time) {
    for (const unsigned index : robots)
      if (strange(index)) (void)server_.fleet().ask_who(index, now());
    (void)wait(again, [&] { return std::none_of(robots.begin(), robots.end(), strange); });
  }
}

unsigned CentralLine::connect_one(const std::string& name) {
  const unsigned index = connect({name}).front();
  if (fleet().robot(index).last == mapper::link::Kind::none)
    fail({fmt::format("{}: {} has a link, but says nothing", verb_, name),
          "switch it off and on: its program may hang"});
  return index;
}

}  // namespace ocm::cli::fleet
