#include <algorithm>
#include <chrono>
#include <cstdio>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "ocm/base/decimal.hpp"
#include "ocm/can/text.hpp"

#include "cli/command/operated_bus.hpp"
#include "cli/logs/format.hpp"
#include "cli/logs/opened_log.hpp"
#include "cli/replay/player.hpp"
#include "cli/replay/stand_in.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/live.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/outgoing.hpp"
#include "cli/shared/output_file.hpp"
#include "cli/shared/values.hpp"
#include "cli/verbs/verb.hpp"
#include "cli/watch/chosen_topics.hpp"
#include "cli/words/quantity.hpp"

namespace ocm::cli {
namespace {

struct ReplayOptions {
  std::string file;
  std::string from_format;
  std::vector<std::string> topics;
  std::string speed = "1";
  std::string loop;
  std::uint64_t passes = 1;  ///< 0: without end
  std::optional<base::Duration> since, until, longest_gap;
  std::string only;
  std::vector<std::string> interfaces;
  bool on_command = false;
  bool dry_run = false;
};

constexpr const char* a_speed = "how many times faster, 0.000001 to 1000000, or max";

base::Result<base::Decimal> parse_speed(const std::string& text) {
  const auto speed = base::parse_decimal(text);
  if (speed && (speed->as_double() < 1e-6 || speed->as_double() > 1e6)) return base::Error::out_of_range;
  return speed;
}

Accepted accepted_speed() {
  return {ValueKind::text, true, a_speed, {}, [](const std::string& text) {
            return text == "max" || static_cast<bool>(parse_speed(text));
          }};
}

bool is_time(const std::string& text) {
  const auto time = words::parse_duration(text);
  return time && time->count() >= 0;
}

/// --from names a format, as everywhere. In version 0.1 it was a time, which --since is now: that still
/// works, as no format is called like a time.
TakeValue take_from(ReplayOptions& options) {
  return [&options](const std::string& text) -> std::optional<Misuse> {
    if (is_time(text))
      options.since = words::parse_duration(text).value;
    else
      options.from_format = text;
    return {};
  };
}

Accepted accepted_from() {
  const auto formats = logs::readable_formats();
  return {ValueKind::text, false, accepted_words(formats).expected, {}, [formats](const std::string& text) {
            return is_time(text) || std::find(formats.begin(), formats.end(), text) != formats.end();
          }};
}

replay::PlayerOptions player_options(const ReplayOptions& options) {
  replay::PlayerOptions player;
  player.at_once = options.speed == "max";
  if (!player.at_once) {
    const auto speed = parse_speed(options.speed);
    if (!speed)
      fail({fmt::format("--speed {}: not a speed", options.speed), fmt::format("write {}", a_speed)},
           exit_usage);
    player.playback.speed = speed->as_double();
  }
  player.span.from = options.since.value_or(player.span.from);
  player.span.until = options.until.value_or(player.span.until);
  player.playback.longest_gap = options.longest_gap.value_or(player.playback.longest_gap);
  if (player.span.until < player.span.from)
    fail({"replay: --until is before --since", "both count from the first frame of the log"}, exit_usage);
  return player;
}

replay::Only parse_only(const std::string& text) {
  if (text == "sensors") return replay::Only::sensors;
  if (text == "commands") return replay::Only::commands;
  return replay::Only::all;
}

/// 0: without end.
std::uint64_t parse_passes(const std::string& text) {
  if (text.empty()) return 0;
  const auto passes = base::parse_unsigned(text);
  if (!passes || *passes == 0)
    fail({fmt::format("--loop {}: not a number of passes", text),
          "write --loop 3, or --loop alone as the last word"},
         exit_usage);
  return *passes;
}

struct Route {
  std::string in_log, bus;
};

std::vector<Route> parse_routes(const std::vector<std::string>& words) {
  std::vector<Route> routes;
  for (const auto& word : words) {
    const auto sign = word.find('=');
    if (sign == std::string::npos || sign == 0 || sign + 1 == word.size())
      fail({fmt::format("--interface {}: not a pair", word),
            "write the log's name and the bus: --interface can0=vcan1"},
           exit_usage);
    const std::string in_log = word.substr(0, sign);
    if (std::any_of(routes.begin(), routes.end(), [&](const Route& route) { return route.in_log == in_log; }))
      fail({fmt::format("--interface {}: '{}' has a bus already", word, in_log),
            "frames of an interface go to one bus: leave one out"},
           exit_usage);
    routes.push_back({in_log, word.substr(sign + 1)});
  }
  return routes;
}

/// The names that --interface has on its right side, each once; `player` gets the way to each.
std::vector<std::string> buses_of(const std::vector<Route>& routes, replay::PlayerOptions& player) {
  std::vector<std::string> names;
  for (const auto& route : routes) {
    const auto known = std::find(names.begin(), names.end(), route.bus);
    player.routes.emplace_back(route.in_log, static_cast<std::size_t>(known - names.begin()));
    if (known == names.end()) names.push_back(route.bus);
  }
  return names;
}

/// These, or where there are none, the bus.
std::vector<replay::Outlet> open_outlets(Session& session, const std::vector<std::string>& buses) {
  std::vector<replay::Outlet> outlets;
  if (buses.empty()) outlets.emplace_back(open_to_command(session, "replay"), session.catalogue_on_bus(true));
  for (const auto& bus : buses)
    outlets.emplace_back(open_to_command(session, "replay", bus), session.catalogue_on(bus));
  return outlets;
}

std::string rounded(base::Duration duration) {
  return words::to_text(std::chrono::duration_cast<std::chrono::microseconds>(duration));
}

void summarise(const replay::Player& player, bool dry_run) {
  const auto& played = player.played();
  const auto lasted = std::chrono::duration_cast<std::chrono::milliseconds>(player.lasted());
  std::string text =
      dry_run ? fmt::format("{} would be sent", counted(played.sent, "frame"))
              : fmt::format("sent {} in {}", counted(played.sent, "frame"), words::to_text(lasted));
  add_count(text, played.not_chosen, "not chosen");
  add_count(text, played.error_frames, "error frame", "left out");
  add_count(text, played.fd_frames, "CAN FD frame", "left out: the bus has none");
  add_count(text, played.no_route, "of interfaces without a bus");
  add_count(text, player.playback().backward(), "with a time before the last");
  add_count(text, player.playback().cut(), "pause", "cut");
  if (player.playback().late() != 0)
    text += fmt::format(", {} later than 1 ms, the latest by {}", player.playback().late(),
                        rounded(player.playback().worst()));
  remark(text);
}

std::string name_of_log(const ReplayOptions& options) {
  return options.file == "-" ? "the standard input" : options.file;
}

/// Of a log with frames none was sent: what was chosen is not in it.
void expect_any(const replay::Player& player, const ReplayOptions& options) {
  const auto& played = player.played();
  const std::string log = name_of_log(options);
  if (played.sent != 0 || interrupted() != 0) return;
  if (played.not_chosen != 0)
    fail({fmt::format("replay: no frame of {} was chosen", log),
          options.file == "-" ? "name other topics, or none: then all frames are sent"
                              : fmt::format("`amiroctl stats {}` shows what it has", options.file)});
  if (played.no_route != 0)
    fail({fmt::format("replay: all frames of {} are of interfaces without a bus", log),
          "name them: --interface LOG=BUS"});
  if (played.error_frames != 0 || played.fd_frames != 0)
    fail({fmt::format("replay: {} has no frame that can be sent there", log), ""});
}

void expect_playable(const ReplayOptions& options) {
  if (options.passes != 1 && options.file == "-")
    fail({"replay: --loop needs a file", "what came on the standard input is gone"}, exit_usage);
  if (options.passes != 1 && options.dry_run)
    fail({"replay: --dry-run plays once", "drop --loop"}, exit_usage);
  if (options.dry_run) refuse_same_file("replay", options.file, "-");
}

/// As often as --loop says. Whether the log is damaged, which is said.
bool play_passes(replay::Player& player, const ReplayOptions& options, const protocol::Catalogue& catalogue,
                 std::unique_ptr<logs::OpenedLog> log) {
  bool damaged = false;
  for (std::uint64_t pass = 1;; ++pass) {
    const std::uint64_t sent_before = player.played().sent;
    player.play(log->reader());
    if (pass == 1) damaged = log->complain();
    const bool last = options.passes != 0 && pass == options.passes;
    // A pass without a frame takes no time: more of them would never end.
    if (last || interrupted() != 0 || player.held_up() || player.played().sent == sent_before) return damaged;
    log = std::make_unique<logs::OpenedLog>(options.file, options.from_format, catalogue);
  }
}

/// Where the log was not played to its end, what would have ended a drive or a behaviour was not sent.
void end_what_was_begun(replay::Player& player, bool cut_short) {
  const bool rested = cut_short && player.rest();
  const auto ended = cut_short ? player.end_behaviours() : std::vector<std::string>{};
  player.expect_all_left();
  if (rested) remark("the motors were set to zero: the log goes on behind this");
  for (const std::string& names : ended) remark(fmt::format("{} ended: the log goes on behind this", names));
}

void play(Session& session, const ReplayOptions& options, int& exit_code) {
  const auto& catalogue = session.catalogue();
  auto chosen = player_options(options);
  replay::Selection selection{catalogue, chosen_topics("replay", catalogue, options.topics),
                              parse_only(options.only)};
  const auto buses = buses_of(parse_routes(options.interfaces), chosen);
  expect_playable(options);
  catch_interrupts();
  catch_hangups();
  auto log = std::make_unique<logs::OpenedLog>(options.file, options.from_format, catalogue);
  std::vector<replay::Outlet> outlets;
  std::unique_ptr<log::Writer> printer;
  if (options.dry_run)
    printer = logs::find_format("candump")->writer(catalogue);
  else
    outlets = open_outlets(session, buses);
  replay::Player player{std::move(chosen), std::move(selection), std::move(outlets), std::move(printer)};
  bool damaged = false;
  try {
    damaged = play_passes(player, options, catalogue, std::move(log));
    end_what_was_begun(player, player.cut_short() || damaged);
  } catch (...) {  // the bus took no more, or the memory is full: what was sent is reported all the same
    for (const std::string& otherwise : player.end_after_all()) remark("replay: " + otherwise);
    if (!options.dry_run) summarise(player, false);
    throw;
  }
  summarise(player, options.dry_run);
  if (const auto lasting = player.held_up())
    fail({fmt::format("replay: held up for {}, so it has ended",
                      words::to_text(std::chrono::duration_cast<std::chrono::milliseconds>(*lasting))),
          "was it stopped, did the machine sleep, or was what it reads too slow? Start it again"});
  if (!damaged) expect_any(player, options);
  exit_code = exit_code_after_interrupt(damaged ? exit_failure : exit_success);
}

/// The samples of the log, between --from and --until.
void learn(replay::StandIn& robot, logs::OpenedLog& log, const replay::Span& span,
           replay::Selection& selection, const protocol::Catalogue& catalogue) {
  std::vector<log::Entry> entries(log::batch);
  std::optional<base::Time> first;
  while (const std::size_t count = log.reader().read(entries)) {
    for (std::size_t i = 0; i < count; ++i) {
      const auto& entry = entries[i];
      if (!first) first = entry.time;
      const base::Duration offset = log::Playback::distance(entry.time, *first);
      const auto frame = entry.classic();
      if (!frame || span.is_before(offset) || span.is_behind(offset) ||
          !selection.has(entry, log.reader().interfaces()))
        continue;
      if (catalogue.has_buses())
        robot.on_interface(entry.interface, log.reader().interfaces().name(entry.interface));
      if (!robot.learn(*frame, entry.interface))
        fail({fmt::format("{} has more frames than fit into the memory for --on-command", log.path()),
              "choose a part of it with --since and --until, or some topics"});
    }
  }
}

void tell_learnt(const replay::StandIn& robot, const protocol::Catalogue& catalogue) {
  std::string text;
  for (const auto& topic : catalogue.topics)
    if (robot.samples(topic) != 0)
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", robot.samples(topic), topic.name);
  remark(fmt::format("samples: {}; waiting for requests, Ctrl-C ends", text));
}

void stand_in(Session& session, const ReplayOptions& options, int& exit_code) {
  using Answer = replay::StandIn::Answer;
  const auto& catalogue = session.catalogue();
  const auto span = player_options(options).span;
  replay::Selection selection{catalogue, chosen_topics("replay", catalogue, options.topics),
                              replay::Only::sensors};
  catch_interrupts();
  replay::StandIn robot{catalogue};
  {
    logs::OpenedLog log{options.file, options.from_format, catalogue};
    learn(robot, log, span, selection, catalogue);
    log.complain();
  }
  if (robot.samples() == 0)
    fail({fmt::format("{} has no sample of {}: nothing could be answered", name_of_log(options),
                      options.topics.empty() ? "a sensor" : "these topics"),
          options.topics.empty() ? "is --spec that of the robot that was recorded?"
                                 : "name others, or none: then all that it has is answered"});
  const auto bus = session.open_bus();
  tell_learnt(robot, catalogue);

  std::uint64_t requests = 0, refused = 0, silent = 0, sent = 0;
  Live live{*bus};
  Outgoing outgoing{*bus, "replay"};
  const auto take = [&](const can::Received& received) {
    switch (robot.take(received.frame, replay::monotonic_now())) {
      case Answer::none:
        return true;
      case Answer::accepted:
        ++requests;
        break;
      case Answer::refused:
        ++refused;
        remark(fmt::format("refused: {}", can::to_text(received.frame).view()));
        break;
      case Answer::silent:
        ++silent;
        remark(fmt::format("{}: the log has no sample of it", can::to_text(received.frame).view()));
        break;
    }
    return false;  // what is due next may have changed
  };
  for (Over over = Over::time; over == Over::time || over == Over::enough;) {
    for (const auto& frame : robot.due(replay::monotonic_now())) {
      outgoing.send(frame);
      ++sent;
    }
    const auto until = robot.next() == base::never
                           ? Live::Clock::time_point::max()
                           : Live::Clock::now() + (robot.next() - replay::monotonic_now());
    // What is due all the time leaves room for requests, such as a stop.
    over = live.receive(std::max(until, Live::Clock::now() + std::chrono::microseconds{100}), take);
    if (over == Over::gone) fail(bus->failure());
  }
  std::string text = fmt::format("{}, {} sent", counted(requests, "request"), counted(sent, "frame"));
  add_count(text, refused, "request", "refused");
  add_count(text, silent, "request", "for what was not recorded");
  remark(text);
  exit_code = exit_code_after_interrupt(exit_success);
}

}  // namespace

void declare_replay(Verb verb, Session& session, int& exit_code) {
  verb.describe("send what was recorded, each frame at its time", log_group,
                "  amiroctl replay drive.log\n"
                "  amiroctl replay drive.pcapng --speed 10 gyro odom\n"
                "  amiroctl replay drive.log --since 1min --until 90s --loop\n"
                "  amiroctl replay both.pcapng --interface can0=vcan0 --interface can1=vcan1\n"
                "  amiroctl replay drive.log --on-command     a robot that is a log");
  const auto options = std::make_shared<ReplayOptions>();
  verb.add_option("file", options->file, "a log in any format, packed or not; - for standard input")
      .required()
      .type_name("FILE")
      .in_usage("FILE|-");
  verb.add_option("topics", options->topics, "only frames of these; default: all that is in the log")
      .type_name("[TOPIC ...]");
  verb.add_value("--from,--from-format", take_from(*options),
                 "the format of the log; default: what it begins with says it")
      .type_name("FORMAT")
      .takes(accepted_from())
      .formerly("--from-format");
  verb.add_option("--speed", options->speed, "how many times faster; max: as fast as the bus takes them")
      .type_name("X|max")
      .takes(accepted_speed());
  const auto loop = verb.add_option("--loop", options->loop, "play it N times; without N until Ctrl-C");
  loop.expected(0, 1).type_name("[N]").takes(
      accepted_whole(1, std::numeric_limits<std::uint64_t>::max(), "how many times, at least 1"));
  add_duration(verb, "--since", options->since, "from this time after the first frame");
  add_duration(verb, "--until", options->until, "up to this time after the first frame");
  add_duration(verb, "--max-gap", options->longest_gap, "cut longer pauses to this");
  verb.add_option("--only", options->only, "sensors: what boards sent; commands: what they were sent")
      .one_of({"sensors", "commands"})
      .type_name("WHICH");
  verb.add_option("--interface", options->interfaces,
                  "frames of the log's interface LOG go to BUS, those of others nowhere; repeatable")
      .type_name("LOG=BUS")
      .one_a_mention();
  verb.add_flag("--on-command", options->on_command,
                "answer requests on the bus with the samples of the log, at the period that is asked for");
  verb.add_flag("--dry-run", options->dry_run, "print the frames, and when they would be sent; send nothing");
  verb.callback([options, loop, verb, &session, &exit_code] {
    if (loop.count() != 0) options->passes = parse_passes(options->loop);
    if (options->on_command) {
      for (const char* option : {"--interface", "--only", "--loop", "--speed", "--max-gap", "--dry-run"})
        if (verb.is_typed(option) || (option == std::string_view{"--dry-run"} && options->dry_run))
          fail({fmt::format("replay: {} with --on-command", option),
                "leave one out: samples are sent when they are asked for, on the bus of --bus"},
               exit_usage);
      stand_in(session, *options, exit_code);
      return;
    }
    play(session, *options, exit_code);
  });
}

}  // namespace ocm::cli
