#include "cli/serve/server.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <poll.h>
#include <span>
#include <sys/random.h>
#include <utility>

#include <fmt/format.h>

#include "ocm/client/commanders.hpp"
#include "ocm/client/diagnosis.hpp"
#include "ocm/log/interfaces.hpp"

#include "cli/bus_model/feed.hpp"
#include "cli/bus_model/models.hpp"
#include "cli/command/operated_bus.hpp"
#include "cli/fleet/known.hpp"
#include "cli/fleet/line_log.hpp"
#include "cli/fleet/line_replay.hpp"
#include "cli/output/printer.hpp"
#include "cli/serve/address.hpp"
#include "cli/serve/bounds.hpp"
#include "cli/serve/channels.hpp"
#include "cli/serve/commands.hpp"
#include "cli/serve/control.hpp"
#include "cli/serve/fleet_player.hpp"
#include "cli/serve/foxglove.hpp"
#include "cli/serve/log_start.hpp"
#include "cli/serve/operator_watch.hpp"
#include "cli/serve/orders.hpp"
#include "cli/serve/parameters.hpp"
#include "cli/serve/scenes.hpp"
#include "cli/serve/sessions.hpp"
#include "cli/serve/state.hpp"
#include "cli/serve/viewers.hpp"
#include "cli/shared/clock.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/live.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/outgoing.hpp"
#include "cli/shared/remedies.hpp"
#include "generator/spec/model.hpp"
#include "generator/spec/spec.hpp"

namespace ocm::cli::serve {
namespace {

using namespace std::chrono_literals;
using bus_model::LogFeed;
using bus_model::Models;
using Presence = OperatorWatch::Presence;

constexpr base::Duration bus_interval = 250ms;  // from one state of the bus to the next
constexpr base::Duration boards_interval = 1s;
constexpr base::Duration playback_interval = 100ms;
constexpr base::Duration play_step = 20ms;  // of a log
constexpr unsigned most_unsent = 64;        // frames, until viewers hear of them

/// So many random bytes, in hexadecimal digits.
std::string random_text(std::size_t bytes) {
  std::vector<unsigned char> numbers(bytes);
  if (::getrandom(numbers.data(), bytes, 0) != static_cast<ssize_t>(bytes))
    fail({"the kernel gives no random numbers", "serve needs them for its token"});
  std::string text;
  for (const unsigned char number : numbers) text += fmt::format("{:02x}", number);
  return text;
}

/// What a bus and a log have in common.
class Server {
 public:
  Server(const protocol::Catalogue& catalogue, const spec::Model& model, ServeOptions options, Source source,
         std::vector<std::string> interfaces, std::uint32_t bus_bit_rate)
      : options_(std::move(options)),
        catalogue_(catalogue),
        model_(model),
        source_(std::move(source)),
        rates_{options_.bit_rate.value_or(bus_bit_rate != 0 ? bus_bit_rate : catalogue_.bit_rate),
               options_.data_bit_rate.value_or(model_.data_bit_rate)},
        channels_(catalogue_, interfaces, options_.fleet.has_value()),
        scenes_(catalogue_, model_, channels_.interfaces(),
                static_cast<std::uint32_t>(channels_.all().size())),
        viewers_(channels_.all().size() + scenes_.channels().size()),
        publisher_(catalogue_, channels_, viewers_),
        models_(catalogue_, rates_.nominal, rates_.data),
        bounds_(catalogue_, rates_.nominal),
        diagnosis_(catalogue_),
        status_requests_(catalogue_),
        parameters_(catalogue_, viewers_),
        sessions_({fmt::format("{}, {}", catalogue_.robot, source_.name), random_text(8), source_.commands,
                   !source_.live, options_.fleet && source_.live ? &fleet_orders_ : nullptr},
                  catalogue_, channels_, viewers_, orders_) {
    channels_.add(scenes_.channels());
    for (const std::string& interface : channels_.interfaces()) models_.of(interface);
    if (interfaces.size() > channels_.interfaces().size())
      remark(fmt::format("serve: {} of {} interfaces have no channels: there would be more than {}",
                         interfaces.size() - channels_.interfaces().size(), interfaces.size(),
                         Channels::most));
  }

  /// Opens the page; leaves where it cannot.
  void open() {
    if (options_.fleet && source_.live)
      fleet_ = std::make_unique<FleetWatch>(*options_.fleet, viewers_, fleet_channels(), fleet_orders_);
    if (options_.commands || options_.web.token_to_view) options_.web.token = random_text(16);
    auto web = Web::open(options_.web, viewers_, sessions_);
    if (!web) fail(web.error);
    web_ = std::move(*web);
    viewers_.publish_state(channels_.of(State::robot), now_ns(),
                           robot_state(catalogue_, model_, channels_, source_));
    const std::string address = page_address(web_->url(), options_.web.token, options_.shows);
    // Without its address nothing of it is of use: an output that is full or gone ends it, with words.
    write_out(address + "\n");
    if (options_.opens) open_in_browser(address);
    if (fleet_ != nullptr) fleet_->run([web = web_.get()] { web->wake(); });
  }

  int run_live(Session& session, std::unique_ptr<transport::Bus> bus);
  int run_alone();
  int run_log(LogFeed& log);
  int run_fleet_log(fleet::LineReplay replay);

 private:
  [[nodiscard]] FleetChannels fleet_channels() const {
    return {channels_.of(State::fleet), channels_.of(State::map)};
  }
  static std::uint64_t now_ns() { return static_cast<std::uint64_t>(unix_time().time_since_epoch().count()); }

  void take(const log::Entry& entry, const log::Interfaces& interfaces) {
    const std::string_view interface = interfaces.name(entry.interface);
    const client::Reception reception = publisher_.take(entry, interface);
    if (reception.meaning == client::Meaning::sample) show(reception.sample, interface);
    diagnosis_.take(reception);
    if (const auto classic = entry.classic()) {
      status_requests_.take({entry.time, *classic}, reception);
      commanders_.take({entry.time, *classic}, reception);
    }
    models_.take(entry, interfaces);
    if (entry.interface == 0) bounds_.take(entry);
  }
  /// What is neither for the bus nor for the log.
  void answer(const Order& order) {
    if (order.kind == Order::Kind::newest) {
      for (const std::uint32_t channel : order.channels)
        if (channel >= channels_.of(State::robot)) {
          if (auto scene = scenes_.newest(channel))
            viewers_.give(order.viewer, channel,
                          static_cast<std::uint64_t>(scene->time.time_since_epoch().count()),
                          std::move(scene->payload));
        } else if (const auto sample =
                       models_.of(channels_.interface_of(channel)).newest_of(channels_.topic_of(channel)))
          viewers_.give(order.viewer, channel,
                        static_cast<std::uint64_t>(sample->time.time_since_epoch().count()),
                        publisher_.text_of(*sample));
      return;
    }
    parameters_.take(order, rows(unix_time()));
  }
  /// Of the first bus.
  [[nodiscard]] std::vector<bus_model::Row> rows(base::Time now) {
    const auto buses = models_.buses();
    return buses.empty() ? std::vector<bus_model::Row>{} : buses.front().model->rows(now, false);
  }
  /// Where the robot is, for panels of others; while a log is wound only what is learnt from it.
  void show(const client::Sample& sample, std::string_view interface) {
    const auto known = channels_.interfaces();
    const auto at = std::find(known.begin(), known.end(), interface);
    scenes_.take(
        sample, static_cast<std::size_t>(at - known.begin()),
        [this](std::uint32_t channel) { return !winds_ && viewers_.wanted(channel); },
        [&](Scenes::Message message) {
          viewers_.publish(message.channel,
                           static_cast<std::uint64_t>(sample.time.time_since_epoch().count()),
                           std::move(message.payload));
        });
  }
  void publish_bounds(base::Time now) {
    const std::uint32_t channel = channels_.of(State::bounds);
    if (!viewers_.wanted(channel)) return;
    bounds_.assume(rows(now));
    viewers_.publish_state(channel, now_ns(), bounds_.state());
  }
  void publish_bus(base::Time now) {
    const std::uint32_t channel = channels_.of(State::bus);
    if (viewers_.wanted(channel))
      viewers_.publish_state(
          channel, now_ns(),
          bus_state(models_.buses(), now, {viewers_.count(), viewers_.lost(), web_->refused()}));
  }
  void publish_boards(const transport::BusCounters& counters, base::Time now) {
    const std::uint32_t channel = channels_.of(State::boards);
    if (!viewers_.wanted(channel)) return;
    std::vector<client::Finding> findings =
        diagnosis_.findings([&](std::size_t board) { return status_requests_.is_due(board, now); });
    const auto disputes = commanders_.findings(catalogue_);
    findings.insert(findings.end(), disputes.begin(), disputes.end());
    for (client::Finding& finding : findings) finding.remedy = remedy(finding);
    const auto counted = findings_of(counters, publisher_.counters());
    findings.insert(findings.end(), counted.begin(), counted.end());
    viewers_.publish_state(channel, now_ns(),
                           boards_state(catalogue_, diagnosis_, status_requests_, findings));
  }
  /// Whether a viewer has subscribed to something of the bus or the log.
  [[nodiscard]] bool is_looked_at() const {
    const auto& all = channels_.all();
    return std::any_of(all.begin(), all.end(), [this](const foxglove::Channel& channel) {
      return !channels_.is_state(channel.id) && viewers_.wanted(channel.id);
    });
  }
  [[nodiscard]] bool is_over() const { return options_.over && options_.over(); }
  void say(const std::string& words) {
    remark("serve: " + words);
    viewers_.tell(0, foxglove::status(foxglove::Level::info, words));
  }
  /// Until the bus is gone, a signal comes, it is over, or (enough) an operator has come or gone. The motors
  /// rest behind it.
  Over serve_bus(transport::Bus& bus, const log::Interfaces& interfaces, const OperatorWatch& watch,
                 const std::function<bool()>& operator_changed);
  /// Viewers first: nothing they say comes any more.
  void close() {
    fleet_.reset();
    web_.reset();
  }
  void sum_up() const {
    if (viewers_.lost() != 0)
      remark(fmt::format("serve: viewers that were too slow have lost {} messages", viewers_.lost()));
  }

  ServeOptions options_;
  const protocol::Catalogue& catalogue_;
  const spec::Model& model_;
  Source source_;
  measure::BitRates rates_;
  Channels channels_;
  Scenes scenes_;
  Viewers viewers_;
  Publisher publisher_;
  Models models_;
  Bounds bounds_;  ///< of the first interface
  client::Diagnosis diagnosis_;
  client::StatusRequests status_requests_;
  client::Commanders commanders_;
  Parameters parameters_;
  Orders orders_;
  std::uint64_t lost_ = 0;  ///< frames, of the bus, as it counts them
  Orders fleet_orders_;
  Sessions sessions_;
  bool winds_ = false;                 ///< a log
  std::unique_ptr<Web> web_;           // its thread uses what is above
  std::unique_ptr<FleetWatch> fleet_;  // last: its thread wakes that one
};

int Server::run_live(Session& session, std::unique_ptr<transport::Bus> bus) {
  log::Interfaces interfaces;
  interfaces.number(bus->name());
  const OperatorWatch watch{std::string{bus->name()}};
  auto* operated = dynamic_cast<OperatedBus*>(bus.get());
  for (;;) {
    // Set points go through an operator from the moment that there is one, and until there is none.
    const auto changed = [&] {
      if (!options_.commands) return false;
      return operated != nullptr ? operated->over() || watch.presence() == Presence::none
                                 : watch.presence() == Presence::runs;
    };
    const Over over = serve_bus(*bus, interfaces, watch, changed);
    if (over != Over::enough) {
      close();
      sum_up();
      if (over == Over::gone && interrupted() == 0) fail(bus->failure());
      return exit_code_after_interrupt(exit_success);
    }
    if (operated != nullptr) bus = std::exchange(operated, nullptr)->release();
    auto link = connect_operator(bus->name(), "serve");
    if (link && *link != nullptr) {
      say(fmt::format("{} guards the robot: set points go through it", (*link)->who()));
      auto guarded =
          std::make_unique<OperatedBus>(std::move(bus), std::move(*link), session.catalogue(), "serve");
      operated = guarded.get();
      bus = std::move(guarded);
    } else if (link) {
      say("no operator runs any more: what viewers command goes to the bus itself");
    }
  }
}

Over Server::serve_bus(transport::Bus& bus, const log::Interfaces& interfaces, const OperatorWatch& watch,
                       const std::function<bool()>& operator_changed) {
  Control control{bus, catalogue_, viewers_,
                  [&](const can::AnyFrame& frame) {
                    log::Entry entry{unix_time(), frame, 0};
                    entry.direction = log::Direction::sent;
                    take(entry, interfaces);
                  },
                  [&]() -> std::string {
                    if (operator_changed()) return "an operator has just started, or ended: say it again";
                    if (watch.presence() == Presence::silent && dynamic_cast<OperatedBus*>(&bus) == nullptr)
                      return "an operator guards the robot, and does not answer: end it, or start it again";
                    return {};
                  }};
  unsigned unsent = 0;
  const auto wake = [&] {
    unsent = 0;
    web_->wake();
  };
  Live live{bus, wake, {orders_.descriptor(), [&] {
                          for (const Order& order : orders_.take()) {
                            answer(order);
                            control.carry_out(order);
                          }
                          wake();
                        }}};
  auto next_bus = Clock::now();
  auto next_boards = next_bus;
  Over over = Over::time;
  while (over == Over::time && !is_over()) {
    auto until = std::min(next_bus, next_boards);
    if (const auto next = control.next()) until = std::min(until, *next);
    over = live.receive_any(until, [&](const transport::ReceivedAny& received) {
      take({received.time, received.frame, 0}, interfaces);
      if (const auto classic = received.frame.classic()) control.heard({received.time, *classic});
      if (++unsent >= most_unsent) wake();
      // What is due is done between two frames, too, however many come.
      if (const auto next = control.next(); next && *next <= Clock::now()) control.advance();
      return true;
    });
    control.advance();
    const auto now = Clock::now();
    if (const auto missed = bus.counters().lost; missed != lost_)
      models_.lost(bus.name(), missed - std::exchange(lost_, missed));
    if (now >= next_bus) {
      models_.until(unix_time());
      publish_bus(unix_time());
      if (parameters_.wanted()) parameters_.update(rows(unix_time()));
      if (viewers_.wanted(channels_.of(State::operator_)))
        viewers_.publish_state(channels_.of(State::operator_), now_ns(), watch.newest());
      next_bus = now + bus_interval;
      if (over == Over::time && operator_changed()) over = Over::enough;
    }
    if (now >= next_boards) {
      publish_boards(bus.counters(), unix_time());
      publish_bounds(unix_time());
      next_boards = now + boards_interval;
    }
    wake();
  }
  if (!control.rest()) complain({"the last set point of rest did not leave", still_moving});
  return over;
}

int Server::run_log(LogFeed& log) {
  const LogFeed::Take taken = [this](const log::Entry& entry, const log::Interfaces& interfaces) {
    take(entry, interfaces);
  };
  LogStart start;
  remark(LogStart::waits);
  bool paused = false;
  std::uint64_t jumps = 0;
  const auto jump = [&](base::Duration at) {
    ++jumps;
    publisher_.hold_back();
    winds_ = true;
    if (log.is_behind(at)) {
      publisher_.forget();
      scenes_.forget();
      models_ = Models{catalogue_, rates_.nominal, rates_.data};
      for (const std::string& interface : channels_.interfaces()) models_.of(interface);
      diagnosis_ = client::Diagnosis{catalogue_};
      status_requests_ = client::StatusRequests{catalogue_};
      bounds_ = Bounds{catalogue_, rates_.nominal};
      log.rewind();
    }
    log.go_to(at, taken);
    // First that it was wound, so that a viewer forgets what was before, then what is there.
    viewers_.publish_state(channels_.of(State::playback), now_ns(),
                           playback_state(log.playing(), paused, jumps));
    publisher_.go_on();
    winds_ = false;
    for (const foxglove::Channel& channel : scenes_.channels())
      if (auto scene = viewers_.wanted(channel.id) ? scenes_.newest(channel.id) : std::nullopt)
        viewers_.publish(channel.id, static_cast<std::uint64_t>(scene->time.time_since_epoch().count()),
                         std::move(scene->payload));
  };
  const auto obey = [&](const Order& order) {
    if (order.kind != Order::Kind::playback) return;
    const auto request = playback_of(order.payload);
    if (!request) return viewers_.tell(order.viewer, foxglove::status(foxglove::Level::error, request.error));
    start.begin();
    if (request->paused >= 0) paused = request->paused == 1;
    if (request->speed > 0) log.faster(request->speed / log.playing().speed);
    if (request->at_s >= 0) jump(base::Duration{static_cast<std::int64_t>(request->at_s * 1e9)});
  };
  auto before = Clock::now();
  auto next_bus = before;
  auto next_boards = before;
  auto next_playback = before;
  while (interrupted() == 0 && !is_over()) {
    pollfd input{orders_.descriptor(), POLLIN, 0};
    const bool asked = wait_for_input(std::span{&input, 1}, play_step);
    const auto now = Clock::now();
    const base::Duration passed = now - std::exchange(before, now);
    if (start.plays(is_looked_at(), viewers_.count() != 0, now) && !paused) log.play(passed, taken);
    models_.until(log.now());
    if (asked) {
      for (const Order& order : orders_.take()) {
        answer(order);
        obey(order);
      }
      next_playback = next_bus = now;
    }
    if (now >= next_playback) {
      viewers_.publish_state(channels_.of(State::playback), now_ns(),
                             playback_state(log.playing(), paused, jumps));
      next_playback = now + playback_interval;
    }
    if (now >= next_bus) {
      publish_bus(log.now());
      next_bus = now + bus_interval;
    }
    if (now >= next_boards) {
      publish_boards({}, log.now());
      publish_bounds(log.now());
      next_boards = now + boards_interval;
    }
    web_->wake();
  }
  close();
  sum_up();
  return exit_code_after_interrupt(exit_success);
}

/// Robots behind a central need no bus: their watch has a thread of its own.
int Server::run_alone() {
  while (interrupted() == 0 && !is_over()) {
    pollfd input{orders_.descriptor(), POLLIN, 0};
    if (wait_for_input(std::span{&input, 1}, bus_interval))
      for (const Order& order : orders_.take())
        if (order.kind == Order::Kind::publish)
          viewers_.tell(order.viewer, foxglove::status(foxglove::Level::error,
                                                       "there is no bus: serve live robots has both"));
    publish_bus(unix_time());
    web_->wake();
  }
  close();
  sum_up();
  return exit_code_after_interrupt(exit_success);
}

/// Robots behind a central, of a log of its line.
int Server::run_fleet_log(fleet::LineReplay replay) {
  FleetPlayer player{std::move(replay), source_.name, viewers_, fleet_channels(),
                     channels_.of(State::playback)};
  LogStart start;
  remark(LogStart::waits);
  auto before = Clock::now();
  auto next_bus = before;
  while (interrupted() == 0 && !is_over()) {
    pollfd input{orders_.descriptor(), POLLIN, 0};
    const bool asked = wait_for_input(std::span{&input, 1}, play_step);
    const auto now = Clock::now();
    const base::Duration passed = now - std::exchange(before, now);
    const bool is_seen = viewers_.wanted(fleet_channels().fleet) || viewers_.wanted(fleet_channels().map);
    if (start.plays(is_seen, viewers_.count() != 0, now)) player.pass(passed);
    if (asked)
      for (const Order& order : orders_.take()) {
        if (order.kind == Order::Kind::playback) start.begin();
        player.obey(order);
      }
    player.publish(now);
    if (now >= next_bus) {
      publish_bus(unix_time());
      next_bus = now + bus_interval;
    }
    web_->wake();
  }
  close();
  sum_up();
  return exit_code_after_interrupt(exit_success);
}

/// Of robots alone, without a bus.
const protocol::Catalogue no_topics{.robot = "mappers", .bit_rate = 0, .boards = {}, .topics = {}};

int run_fleet_log(ServeOptions options, Source source) {
  const fleet::Known known = fleet::known_of("serve", options.fleet->world, options.fleet->starts);
  fleet::ReadLineLog log = fleet::read_line_log("serve", options.log);
  if (log.damaged != 0)
    remark(fmt::format("serve: {}: {} could not be read, the first is line {}", options.log,
                       counted(log.damaged, "line"), log.first_damaged));
  if (log.said.empty())
    fail({fmt::format("serve: {}: nothing that a central has said is in it", options.log),
          "was it recorded while robots had links?"});
  static const spec::Model no_model;
  Server server{no_topics, no_model, std::move(options), std::move(source), {}, 0};
  server.open();
  return server.run_fleet_log(fleet::LineReplay{std::move(log), known});
}

}  // namespace

void check_has_page(std::string_view verb) {
  if (has_websockets && has_page()) return;
  fail({fmt::format("{} needs libwebsockets and dygraphs, which were missing when this amiroctl was built",
                    verb),
        "install libwebsockets-dev and libjs-dygraphs, then build it again: scripts/build"});
}

int run(Session& session, ServeOptions options) {
  check_has_page("serve");
  catch_interrupts();
  catch_hangups();
  Source source{{}, options.log.empty(), options.commands};
  if (!options.log.empty()) {
    source.name = std::filesystem::path{options.log}.filename().string();
    if (options.fleet) return run_fleet_log(std::move(options), std::move(source));
    LogFeed log{options.log, options.format, session.catalogue()};
    if (interrupted() != 0) return exit_code_after_interrupt(exit_success);
    Server server{session.catalogue(), session.spec().model(), std::move(options),
                  std::move(source),   log.interfaces(),       0};
    server.open();
    return server.run_log(log);
  }
  if (!options.bus) {
    static const spec::Model no_model;
    const std::string& path = options.fleet->line.path;
    source.name = path.empty() ? "central" : path;
    Server server{no_topics, no_model, std::move(options), std::move(source), {}, 0};
    server.open();
    return server.run_alone();
  }
  auto bus = options.commands ? open_to_command(session, "serve") : session.open_bus();
  source.name = std::string{bus->name()};
  Server server{session.catalogue(), session.spec().model(), std::move(options), source,
                {source.name},       bus->bit_rate()};
  server.open();
  return server.run_live(session, std::move(bus));
}

}  // namespace ocm::cli::serve
