#include "cli/fleet/owner.hpp"

#include <algorithm>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "cli/shared/local_link.hpp"

namespace ocm::cli::fleet {
namespace {

using answers::no;
using answers::yes;
using mapper::server::Calibrator;

/// Room for what is not a row.
constexpr std::size_t most_of_rows = longest_local_message - 2'000;
constexpr std::size_t page_bytes = 48'000;
/// What failed, kept for a caller that does not ask.
constexpr std::size_t most_failed = 16;

}  // namespace

Owner::Owner(std::string verb, cognitive::Server& server, std::unique_ptr<LocalServer> service)
    : self_(fmt::format("{} (process {})", verb, ::getpid())),
      verb_(std::move(verb)),
      server_(&server),
      service_(std::move(service)) {
  if (!service_) return;
  service_->begin({[] { return std::make_unique<LineCaller>(); },
                   [this](LocalCaller& caller) {
                     static_cast<LineCaller&>(caller).asked = now_;
                     static_cast<LineCaller&>(caller).views =
                         closing_;  // it asks again, and is not waited for
                     if (!closing_) ++joined_;
                     return closing_ ? answers::wait() : yes(verb_);
                   },
                   [this](LocalCaller& caller, std::string_view request) {
                     return answer(static_cast<LineCaller&>(caller), request);
                   },
                   [this](LocalCaller& caller) { gone(static_cast<LineCaller&>(caller)); }});
}

void Owner::serve(base::Time now) {
  now_ = now;
  if (!service_) return;
  if (server_->client().idle())  // requests are done in their order
    service_->for_each([](LocalCaller& caller) { static_cast<LineCaller&>(caller).waits = false; });
  service_->serve();
  for (unsigned index = 0; index < orders_.size(); ++index) {
    const LineCaller* const caller = orders_[index].caller;
    if (caller != nullptr && is_busy(index) && now - caller->asked > lease)
      stop_left(fmt::format("{}: {} said nothing for 2 s", self_, caller->who()), index);
  }
}

void Owner::failed(const std::string& words) {
  if (!service_) return;
  service_->for_each([&words](LocalCaller& each) {
    auto& caller = static_cast<LineCaller&>(each);
    if (caller.waits && caller.failed.size() < most_failed) caller.failed.push_back(words);
  });
}

// --- orders ---

bool Owner::is_busy(unsigned index) const {
  const auto compass = server_->fleet().calibrator(index).phase();
  return !is_final(server_->fleet().sender(index).progress()) ||
         (compass != Calibrator::Phase::none && compass != Calibrator::Phase::done);
}

std::optional<transport::Failure> Owner::taken(const LineCaller* caller, unsigned index) const {
  const Order& order = orders_[index];
  const bool other = caller != nullptr ? order.own || (order.caller != nullptr && order.caller != caller)
                                       : order.caller != nullptr;
  if (!other || !is_busy(index)) return std::nullopt;
  const std::string& name = server_->fleet().robot(index).name;
  const bool stopping = server_->fleet().sender(index).progress() == mapper::server::Progress::stopping;
  return transport::Failure{
      fmt::format("{} is {} by {}", name, stopping ? "being stopped" : "driven", order.by),
      fmt::format("wait until that is over{}",
                  stopping ? "" : fmt::format(", or stop it: amiroctl goto {} 0 0", name))};
}

void Owner::note(const LineCaller* caller, unsigned index) {
  Order& order = orders_[index];
  order = {++number_, caller != nullptr ? caller->who() : self_, caller, caller == nullptr};
  if (caller != nullptr) holders_[index] = caller->who();
}

std::optional<transport::Failure> Owner::order(const LineCaller* caller, unsigned index,
                                               const mapper::link::SetPoint& to, base::Time now) {
  if (to != mapper::link::SetPoint{})
    if (auto failure = taken(caller, index)) return failure;
  (void)server_->fleet().go(index, to, now);
  note(caller, index);
  return std::nullopt;
}

std::optional<transport::Failure> Owner::calibrate(const LineCaller* caller, unsigned index, bool only_ask,
                                                   base::Time now) {
  if (auto failure = taken(caller, index)) return failure;
  (void)server_->fleet().calibrate(index, now, only_ask);
  if (!only_ask) note(caller, index);
  return std::nullopt;
}

void Owner::leave(const LineCaller* caller, unsigned index) {
  Order& order = orders_[index];
  if (order.caller == caller) order.caller = nullptr;
  order.own = order.own && caller != nullptr;
}

void Owner::stop_left(const std::string& why, unsigned index) {
  (void)server_->fleet().stop(index, now_);
  orders_[index] = {++number_, why, nullptr, false};
}

void Owner::gone(const LineCaller& caller) {
  for (unsigned index = 0; index < orders_.size(); ++index) {
    if (orders_[index].caller != &caller) continue;
    if (is_busy(index))
      stop_left(fmt::format("{}: {} has ended", self_, caller.who()), index);
    else
      orders_[index].caller = nullptr;
  }
}

// --- what is known ---

RobotNow Owner::robot(unsigned index) const {
  const mapper::server::Peer* const peer = server_->client().peer(index);
  RobotNow now =
      robot_now(server_->fleet(),
                peer != nullptr ? *peer : mapper::server::Peer{index, "", fmt::format("robot {}", index)});
  now.order = orders_[index].number;
  now.by = orders_[index].by;
  now.held = explores_ && held(index);
  return now;
}

bool Owner::driven_by_other(unsigned index) const {
  return index < orders_.size() && orders_[index].caller != nullptr && is_busy(index);
}

std::vector<unsigned> Owner::driven_by_others() const {
  std::vector<unsigned> robots;
  for (unsigned index = 0; index < orders_.size(); ++index)
    if (driven_by_other(index)) robots.push_back(index);
  return robots;
}

std::vector<std::string> Owner::at_work(base::Time now) const {
  std::vector<std::string> names;
  if (service_)
    service_->for_each([&](const LocalCaller& each) {
      const auto& caller = static_cast<const LineCaller&>(each);
      if (!caller.views && now - caller.asked <= lease) names.push_back(caller.who());
    });
  return names;
}

// --- answers ---

std::string Owner::answer(LineCaller& caller, std::string_view text) {
  caller.asked = now_;
  const auto request = parse_line_request(text);
  if (!request)
    return no("that is no request to the owner of a central's line", "docs/cognitive.md has them");
  return answer(caller, *request);
}

std::string Owner::answer(LineCaller& caller, const LineRequest& request) {
  using Kind = LineRequest::Kind;
  auto& fleet = server_->fleet();
  const unsigned index = request.robot;
  const auto full = [] { return no("the central has too many requests to do", "ask again"); };
  switch (request.kind) {
    case Kind::robots:
    case Kind::json:
      return rows(caller, request);
    case Kind::scan:
    case Kind::connect:
      if (!(request.kind == Kind::scan ? server_->client().scan(request.time)
                                       : server_->client().connect(index)))
        return full();
      caller.waits = true;
      return yes();
    case Kind::go:
      return ordered(order(&caller, index, request.set_point, now_), index);
    case Kind::stop:
      return ordered(order(&caller, index, {}, now_), index);
    case Kind::calibrate:
    case Kind::compass:
      return ordered(calibrate(&caller, index, request.kind == Kind::compass, now_), index);
    case Kind::leave:
      leave(&caller, index);
      return yes();
    case Kind::pause:
    case Kind::unpause:
      holders_[index] = request.kind == Kind::pause ? caller.who() : std::string{};
      (void)(request.kind == Kind::pause ? fleet.pause(index, now_) : fleet.unpause(index, now_));
      return yes();
    case Kind::ping:
      (void)fleet.ping(index);
      return yes();
    case Kind::who:
      (void)fleet.ask_who(index, now_);
      return yes();
    case Kind::map:
      caller.views = true;
      caller.document = draw_ ? draw_(request.form) : std::string{};
      if (!draw_) return no(fmt::format("{} draws no map", self_), "end it, and start a map");
      return page(caller, 0);
    case Kind::more:
      return page(caller, request.offset);
  }
  return {};
}

std::string Owner::ordered(const std::optional<transport::Failure>& failure, unsigned index) const {
  return failure ? no(failure->what, failure->remedy) : yes(std::to_string(orders_[index].number));
}

/// First a line on the caller's own requests: "idle" or "waits", and a line of each that failed; then rows,
/// and "more INDEX" where not all found room.
std::string Owner::rows(LineCaller& caller, const LineRequest& request) {
  const bool json = request.kind == LineRequest::Kind::json;
  std::string text;
  if (!json) {
    text = caller.waits ? "waits\n" : "idle\n";
    for (const std::string& words : std::exchange(caller.failed, {})) text += "failed " + words + "\n";
  }
  std::vector<mapper::server::Peer> peers = server_->client().peers();
  std::sort(peers.begin(), peers.end(), [](const auto& a, const auto& b) { return a.index < b.index; });
  for (const mapper::server::Peer& peer : peers) {
    if (peer.index < request.robot) continue;
    const std::string row = json ? to_json(robot(peer.index)).line() : to_row(robot(peer.index));
    if (text.size() + row.size() > most_of_rows) return yes(text + fmt::format("more {}\n", peer.index));
    text += row + "\n";
  }
  return yes(text);
}

/// The size of all of it, and from the next line on what there is from `offset` on.
std::string Owner::page(const LineCaller& caller, std::uint64_t offset) const {
  const auto from = static_cast<std::size_t>(std::min<std::uint64_t>(offset, caller.document.size()));
  return yes(fmt::format("{}\n", caller.document.size()) + caller.document.substr(from, page_bytes));
}

}  // namespace ocm::cli::fleet
