/// This machine as the central of mappers, in place of the dongle at the server.
#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <memory>
#include <poll.h>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "ocm/host/system_time.hpp"
#include "ocm/mapper/link/prefix.hpp"
#include "ocm/transport/pty.hpp"

#include "cli/central/server_end.hpp"
#include "cli/central/switchboard.hpp"
#include "cli/fleet/keeper.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/values.hpp"
#include "cli/verbs/verb.hpp"

namespace ocm::cli {
namespace {

using namespace std::chrono_literals;
using central::RobotLine;
using central::ServerEnd;
using central::Switchboard;

struct CentralOptions {
  std::vector<std::string> robots;  ///< NAME=PATH
  std::uint32_t baud = 38'400;
  bool pty = false;
  std::string link;
  bool own = false;
  bool call_back = false;
  fleet::LineOptions line{};  ///< of the central that is there, with --own
};

/// How long to wait at most, so that a signal, a program that comes or a robot that appears is seen soon.
constexpr base::Duration longest_wait = 50ms;
/// What was typed before the end may still go to the robots.
constexpr base::Duration farewell = 1s;

base::Time now() {
  return base::Time{
      std::chrono::duration_cast<base::Duration>(std::chrono::steady_clock::now().time_since_epoch())};
}

RobotLine parse_robot(const std::string& text) {
  const auto equals = text.find('=');
  RobotLine robot{text.substr(0, equals), equals == std::string::npos ? "" : text.substr(equals + 1)};
  if (robot.name.empty() || robot.path.empty())
    fail({fmt::format("central: --robot '{}' is not NAME=PATH", text), "as in --robot AVR=/dev/ttyUSB0"},
         exit_usage);
  if (mapper::link::safe_name(robot.name).view() != robot.name)
    fail({fmt::format("central: a robot cannot be called '{}'", robot.name),
          fmt::format("use at most {} printed characters, none of : [ ] {{ }}", mapper::link::max_name)},
         exit_usage);
  return robot;
}
std::vector<RobotLine> parse_robots(const std::vector<std::string>& texts) {
  std::vector<RobotLine> robots;
  std::set<std::string> names;
  std::set<std::string> paths;
  for (const std::string& text : texts) {
    RobotLine robot = parse_robot(text);
    if (!names.insert(robot.name).second)
      fail({fmt::format("central: two robots are called '{}'", robot.name), "give each a name of its own"},
           exit_usage);
    if (!paths.insert(robot.path).second)
      fail({fmt::format("central: two robots on '{}'", robot.path), "each has a line of its own"},
           exit_usage);
    robots.push_back(std::move(robot));
  }
  if (robots.size() > Switchboard::max_robots)
    fail({fmt::format("central: {} robots", robots.size()),
          fmt::format("it takes at most {}", Switchboard::max_robots)},
         exit_usage);
  return robots;
}

std::unique_ptr<ServerEnd> open_server(const CentralOptions& options) {
  if (!options.pty) return central::standard_streams();
  std::string link = options.link;
  if (link.empty()) {
    if (auto problem = transport::make_line_folders()) fail(*problem);
    link = transport::central_line();
  }
  auto pty = transport::Pty::open(link);
  if (!pty) fail(pty.error);
  return central::pseudo_terminal(std::move(*pty));
}

void wait(const Switchboard& board, const ServerEnd& server, base::Duration limit) {
  std::vector<pollfd> inputs;
  server.watch(inputs, board.output().size() < Switchboard::max_output, !board.output().empty());
  board.watch(inputs);
  const timespec time = host::to_timespec(limit);
  ::ppoll(inputs.data(), inputs.size(), &time, nullptr);
}

/// Until the server has ended and its last words are with the robots, or a signal has come.
void serve(Switchboard& board, ServerEnd& server) {
  std::array<char, 4096> room{};
  for (base::Time give_up = base::never; interrupted() == 0;) {
    const bool attached = server.attached();
    if (board.output().size() < Switchboard::max_output) {
      const std::size_t size = server.read(room);
      board.feed({room.data(), size}, now());
    }
    board.work(now());
    if (attached)
      board.taken(server.write(board.output()));
    else
      board.discard();
    if (server.over()) {
      if (give_up == base::never) give_up = now() + farewell;
      if (now() >= give_up || (!board.busy() && (board.output().empty() || !server.attached()))) break;
    }
    const base::Duration limit = server.over() ? base::Duration{5ms} : longest_wait;
    wait(board, server, std::clamp<base::Duration>(board.due() - now(), 0ms, limit));
  }
}

}  // namespace

void declare_central(Verb verb, Session&, int& exit_code) {
  verb.describe(
      "this machine as the central of mappers on serial lines", mapper_group,
      "  amiroctl central --robot AVR=/dev/ttyUSB0   type start, list, conn 0, {S,CON}\n"
      "  amiroctl central --pty                      for a server that opens a serial line\n"
      "  amiroctl sim --robots 2 --lines             simulated robots, each with a line of its own\n"
      "  amiroctl central                            connects those\n"
      "  amiroctl central --own                      has the central's line for robots, goto, ...");
  const auto options = std::make_shared<CentralOptions>();
  const auto robots = verb.add_option("--robot", options->robots,
                                      "a robot's serial line; default: those of `sim --robots N --lines`")
                          .type_name("NAME=PATH");
  const auto baud =
      verb.add_option("--baud", options->baud, "of the robots' lines; with --own of the central's")
          .type_name("N")
          .show_default();
  const auto pty =
      verb.add_option("--pty", options->link,
                      "serve the program that opens LINK, a pseudo terminal; default: the line that "
                      "`robots`, `goto` and others open")
          .expected(0, 1)
          .type_name("[LINK]");
  const auto own =
      verb.add_flag("--own", options->own,
                    "be no central: have the line of one, for the programs that join, until Ctrl-C")
          .excludes(pty)
          .excludes(robots);
  verb.add_flag(
          "--call-back", options->call_back,
          "if the link to a robot that drives gets bad: stop it, and send it back towards where it began")
      .needs(own);
  verb.add_option("--central", options->line.path,
                  "the line; default: that of `sim --robots` or `central --pty`")
      .type_name("PATH")
      .needs(own);
  for (Option each : fleet::add_dongle_kind(verb, options->line.dongle)) each.needs(own);
  fleet::add_record_option(verb, options->line).needs(own);
  add_duration(verb, "--scan", options->line.scan, "how long to look for robots; default: 3s").needs(own);
  verb.callback([options, pty, baud, &exit_code] {
    if (options->own) {
      if (baud.count() > 0) options->line.dongle.baud = options->baud;
      exit_code = fleet::keep_line(options->line, options->call_back);
      return;
    }
    options->pty = pty.count() > 0;
    central::SwitchboardOptions lines{parse_robots(options->robots), "", options->baud};
    if (const auto nearest = transport::detail::nearest_serial_speed(options->baud); nearest != options->baud)
      fail({fmt::format("central: a serial line has no speed {} here", options->baud),
            fmt::format("the nearest is {}", nearest)},
           exit_usage);
    std::error_code error;
    for (const RobotLine& robot : lines.robots)
      if (!std::filesystem::exists(robot.path, error))
        remark(fmt::format("no {} yet; {} is looked for while the central scans", robot.path, robot.name));
    if (lines.robots.empty()) {
      lines.folder = transport::robot_lines();
      if (!std::filesystem::exists(lines.folder, error) || std::filesystem::is_empty(lines.folder, error))
        remark(fmt::format("no robots in {} yet; each `start` looks again. --robot NAME=PATH names one",
                           lines.folder));
    }
    catch_interrupts();
    catch_hangups();
    std::signal(SIGPIPE, SIG_IGN);  // seen where it is written
    const auto server = open_server(*options);
    if (options->pty)
      remark(fmt::format("central on {}; Ctrl-C ends it",
                         options->link.empty() ? transport::central_line() : options->link));
    Switchboard board{std::move(lines)};
    serve(board, *server);
    board.restart();
    board.print_summary();
    exit_code = exit_code_after_interrupt(exit_success);
  });
}

}  // namespace ocm::cli
