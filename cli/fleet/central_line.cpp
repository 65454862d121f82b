#include "cli/fleet/central_line.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "ocm/transport/pty.hpp"
#include "ocm/transport/virtual_bus.hpp"

#include "cli/fleet/line_request.hpp"
#include "cli/fleet/line_time.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/values.hpp"
#include "cli/words/quantity.hpp"

namespace ocm::cli::fleet {
namespace {

using namespace std::chrono_literals;
using mapper::server::Peer;

constexpr host::LocalService central_line_service{"a central's line", "a program with a central's line",
                                                  host::Cause::other, false};
/// How long to look for robots that are not listed.
constexpr base::Duration usual_scan = 3s;
/// How long a robot may take from its link to its first word: it measures its gyro first.
constexpr base::Duration first_word = 8s;
/// And one of which pieces come: a handshake is two packets, and at 60 % loss whole every sixth time.
constexpr base::Duration first_whole_word = 40s;
/// How long a request may take at the central, with all its time-outs.
constexpr base::Duration request_timeout = 60s;
/// How long the program that has the line may take to answer: it may look for the kind of its dongle, at two
/// speeds.
constexpr base::Duration longest_opening = 10s;

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
  add_duration(verb, "--scan", options.scan, "how long to look for robots that are not listed; default: 3s");
}

Option add_record_option(Verb verb, LineOptions& options) {
  return verb
      .add_option("--record", options.record, "what the central says, with times, for `serve robots FILE`")
      .type_name("FILE");
}

namespace {

/// The path of the line, and how to speak on it.
struct Place {
  std::string path;
  DongleOptions dongle;
};
Place place_of(std::string_view verb, const LineOptions& options) {
  if (!options.path.empty()) return {options.path, options.dongle};
  // The link that a killed simulator has left may lead to a terminal of another user.
  const std::string path = transport::central_line();
  if (!transport::is_served(path))
    fail(
        {fmt::format(
             "{}: there is no central at '{}'{}", verb, path,
             transport::VirtualBus::running() ? "; the simulator that runs is an AMiRo, which has none" : ""),
         "start one (amiroctl sim --robots 2, or amiroctl central --pty), or name a dongle: --central "
         "/dev/ttyACM0"});
  Place place{path, options.dongle};
  place.dongle.kind = "ours";
  return place;
}

/// Who serves the line answers; else this program does. The socket is there first, so that of two programs
/// that start together one joins the other.
std::unique_ptr<LineEnd> open_end(std::string_view verb, const LineOptions& options, Need need,
                                  const cognitive::FleetOptions& fleet) {
  const Place place = place_of(verb, options);
  const std::string socket = local_socket("line", digits_of_path(place.path));
  const std::string what = fmt::format("the program that has '{}'", place.path);
  const base::Time end = line_time() + longest_opening;
  for (transport::Failure why;; sleep_for(50ms)) {
    if (interrupted() != 0) throw Exit{exit_code_after_interrupt(exit_failure)};
    if (line_time() >= end) fail({fmt::format("{}: {}", verb, why.what), why.remedy});
    auto link = LocalLink::connect(socket, what, verb);
    if (!link) {  // it still opens the line, is about to end, or is stopped
      why = std::move(link.error);
      continue;
    }
    if (*link && (*link)->greeting().empty()) {
      why = {fmt::format("{}{} is about to end, and still has the line", what, (*link)->process()),
             "wait until the programs that have joined it have ended"};
      continue;
    }
    if (*link) {
      (*link)->set_who((*link)->greeting() + (*link)->process());
      if (need == Need::own)
        fail({fmt::format("{}: {} has the central's line", verb, (*link)->who()),
              fmt::format("{} needs it for itself: end that one first", verb)});
      return std::make_unique<JoinedLine>(verb, std::move(*link));
    }
    auto served = LocalServer::open(socket, central_line_service);
    if (!served && served.error.process != 0) {  // since a moment
      why = std::move(served.error);
      continue;
    }
    if (!served) remark(fmt::format("{}: no other program can join: {}", verb, served.error.what));
    return std::make_unique<OwnLine>(verb, open_dongle(verb, place.path, place.dongle), fleet,
                                     served ? std::move(*served) : nullptr);
  }
}

}  // namespace

std::unique_ptr<JoinedLine> join_line(std::string_view verb, const LineOptions& options) {
  const Place place = place_of(verb, options);
  auto link = LocalLink::connect(local_socket("line", digits_of_path(place.path)),
                                 fmt::format("the program that has '{}'", place.path), verb);
  if (!link) fail({fmt::format("{}: {}", verb, link.error.what), link.error.remedy});
  if (!*link || (*link)->greeting().empty()) return nullptr;
  (*link)->set_who((*link)->greeting() + (*link)->process());
  return std::make_unique<JoinedLine>(verb, std::move(*link));
}

CentralLine::CentralLine(std::string_view verb, const LineOptions& options, Need need,
                         const cognitive::FleetOptions& fleet)
    : verb_(verb), scan_(options.scan) {
  if (scan_ > longest_scan)
    fail({fmt::format("{}: --scan {}: a central that looks for robots says nothing to those that it has",
                      verb, words::to_text(*scan_)),
          fmt::format("write at most {}", words::to_text(longest_scan))},
         exit_usage);
  catch_interrupts();
  catch_hangups();
  end_ = open_end(verb, options, need, fleet);
  if (options.record.empty()) return;
  if (own() == nullptr)
    fail({fmt::format("{}: --record: {} has the central's line", verb, end_->path()),
          "record there: central --own --record FILE, or map --record FILE"},
         exit_usage);
  own()->record(std::make_unique<LineLog>(verb, options.record));
}

base::Time CentralLine::now() {
  return line_time();
}

bool CentralLine::halt(const std::vector<unsigned>& robots) {
  return fleet::halt(*end_, verb_, robots, [this](unsigned index) { return end_->is_charge(index); });
}

bool CentralLine::run(std::optional<base::Duration> limit, const std::function<bool()>& done) {
  const base::Time begin = now();
  while (interrupted() == 0) {
    if (done()) return true;
    if (limit && now() - begin >= *limit) return false;
    end_->exchange();
  }
  return false;
}

bool CentralLine::wait(base::Duration limit, const std::function<bool()>& done) {
  const bool was_done = run(limit, done);
  if (interrupted() != 0) throw Exit{exit_code_after_interrupt(exit_failure)};
  return was_done;
}

void CentralLine::list(base::Duration scan) {
  (void)end_->take_failed();
  end_->scan(scan);
  (void)wait(scan + request_timeout, [this] { return end_->idle(); });
  if (const auto failed = end_->take_failed(); !failed.empty())
    fail({fmt::format("{}: {}: {}", verb_, end_->path(), failed.front()),
          "is it a central? Unplug the dongle and plug it in again, or restart the simulation"});
}

const std::vector<Peer>& CentralLine::scan() {
  list(scan_.value_or(usual_scan));
  return end_->peers();
}

std::optional<unsigned> CentralLine::find(const std::string& name) const {
  const auto& peers = end_->peers();
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
  const auto& peers = end_->peers();
  fail({fmt::format("{}: the central finds no robot '{}'", verb_, name),
        peers.empty() ? "it finds none at all: is the robot switched on, and near?"
                      : fmt::format("it finds {}", listed(peers))});
}

std::vector<unsigned> CentralLine::connect(const std::vector<std::string>& names) {
  const bool all = names.empty() || std::find(names.begin(), names.end(), "all") != names.end();
  // While one program scans, no other speaks to its robots: what the other one has found will do.
  const bool known = joined() != nullptr && !end_->peers().empty();
  if (!known) list(0s);
  const bool look =
      all ? !known || scan_.has_value()
          : std::any_of(names.begin(), names.end(), [this](const auto& name) { return !find(name); });
  if (look) list(scan_.value_or(usual_scan));
  std::vector<unsigned> wanted;
  if (all)
    for (const Peer& peer : end_->peers()) wanted.push_back(peer.index);
  if (!all)
    for (const std::string& name : names) {
      const auto index = find(name);
      if (!index) unknown(name);
      if (std::find(wanted.begin(), wanted.end(), *index) == wanted.end()) wanted.push_back(*index);
    }
  if (wanted.empty())
    fail({fmt::format("{}: the central finds no robot", verb_),
          "is one switched on, and near? --scan 10s looks for longer"});
  (void)end_->take_failed();
  std::vector<std::string> meant;
  for (const unsigned index : wanted) {
    meant.push_back(robot(index).address);
    end_->connect(index);
  }
  // One after the other: of one that is silent its own time-out is waited for.
  (void)wait(static_cast<int>(wanted.size()) * request_timeout, [this] { return end_->idle(); });
  for (const std::string& words : end_->take_failed()) {
    if (wanted.size() == 1)
      fail({fmt::format("{}: {}", verb_, words), "is it near enough? `amiroctl robots` lists robots"});
    remark(fmt::format("{}: {}", verb_, words));
  }
  for (std::size_t i = 0; i < wanted.size(); ++i)
    if (robot(wanted[i]).address != meant[i])
      fail({fmt::format("{}: another program has looked for robots, and the list has changed", verb_),
            "say it again"});
  unreached_ = std::erase_if(wanted, [this](unsigned index) { return !robot(index).linked; });
  if (wanted.empty()) fail({fmt::format("{}: no robot could be connected", verb_), "are they near enough?"});
  const base::Time begin = now();
  (void)wait(first_whole_word, [&] {
    return std::all_of(wanted.begin(), wanted.end(), [&](unsigned index) {
      const RobotNow now_is = robot(index);
      return now_is.last != mapper::link::Kind::none || (now_is.torn == 0 && now() - begin >= first_word);
    });
  });
  return wanted;
}

void CentralLine::introduce(const std::vector<unsigned>& robots) {
  constexpr base::Duration again = 500ms;
  constexpr int times = 6;  // a handshake is two packets: at 30 % loss one of six comes whole in 98 of 100
  const auto strange = [this](unsigned index) {
    const RobotNow now_is = robot(index);
    return now_is.linked && now_is.last != mapper::link::Kind::none && !now_is.handshake;
  };
  for (int time = 0; time < times && std::any_of(robots.begin(), robots.end(), strange); ++time) {
    for (const unsigned index : robots)
      if (strange(index)) end_->ask_who(index);
    (void)wait(again, [&] { return std::none_of(robots.begin(), robots.end(), strange); });
  }
}

unsigned CentralLine::connect_one(const std::string& name) {
  const unsigned index = connect({name}).front();
  if (robot(index).last == mapper::link::Kind::none)
    fail({fmt::format("{}: {} has a link, but says nothing", verb_, name),
          "switch it off and on: its program may hang"});
  return index;
}

}  // namespace ocm::cli::fleet
