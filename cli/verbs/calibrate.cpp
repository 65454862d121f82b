/// A mapper turns around once to calibrate its compass; how good that is, and whether it is stored.
#include <chrono>
#include <memory>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "cli/fleet/central_line.hpp"
#include "cli/fleet/pause_seen.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/values.hpp"
#include "cli/verbs/verb.hpp"
#include "cli/words/quantity.hpp"

namespace ocm::cli {
namespace {

using namespace std::chrono_literals;
using fleet::RobotNow;
using mapper::server::Calibrator;
using Result = mapper::link::Calibration;

struct CalibrateOptions {
  fleet::LineOptions line;
  std::string robot;
  base::Duration timeout = 90s;
  bool show = false;
};

/// How long it is asked what it knows: a robot whose program is older never answers.
constexpr base::Duration answers_within = 10s;

std::string figures(const Result& result) {
  return fmt::format("within {} deg; field of the robot x {} mG, y {} mG, of the earth {} mG", result.error,
                     result.x, result.y, result.field);
}
std::string_view use_of(const Result& result) {
  if (result.use == Result::stored) return "stored";
  return result.use == Result::until_off ? "not stored" : "not used";
}
/// What it corrects by when the calibration has failed.
std::string_view what_remains(const Result& result) {
  return result.use == Result::unused ? "its compass corrects nothing"
                                      : "it keeps the calibration that it had";
}

/// Why there is no good calibration, and what to do.
struct Reason {
  std::string what;
  std::string_view remedy;
};
Reason reason_of(const std::string& name, const Result& result) {
  constexpr std::string_view elsewhere =
      "calibrate it in another place, away from steel, motors and cables with current";
  switch (result.verdict) {
    case Result::none:
      return {fmt::format("{} was never calibrated", name), "drop --show: it turns around once"};
    case Result::turning:
      return {fmt::format("{} turns around now, for another program", name), "ask again in a minute"};
    case Result::poor:
      return {fmt::format("{} may be wrong by {} deg; a robot that has a good calibration keeps that", name,
                          result.error),
              elsewhere};
    case Result::stopped:
      return {fmt::format("{} was stopped before it had turned around; {}", name, what_remains(result)),
              "calibrate it again"};
    case Result::incomplete:
      return {fmt::format("{} has not seen itself turn around; {}", name, what_remains(result)),
              "is it free to turn, and does its gyroscope answer?"};
    case Result::disturbed:
      return {fmt::format("the field changed while {} turned: its compass would be wrong by {} deg; {}", name,
                          result.error, what_remains(result)),
              elsewhere};
    case Result::weak:
      return {
          fmt::format("the field around {} is too weak, {} mG; {}", name, result.field, what_remains(result)),
          elsewhere};
    default:
      return {fmt::format("the compass of {} does not answer; {}", name, what_remains(result)),
              "check the part and its cable"};
  }
}

int report(const std::string& name, const Result& result) {
  const bool good = result.verdict == Result::good;
  if (good || result.verdict == Result::poor)
    fmt::print("{}: {}: {}; {}\n", name, good ? "good" : "poor", figures(result), use_of(result));
  if (good && result.use == Result::stored) return exit_success;
  const Reason reason =
      good ? Reason{fmt::format("{} has not stored it: it is lost when the robot is switched off", name),
                    "check the robot's memory, and calibrate it again"}
           : reason_of(name, result);
  remark(fmt::format("calibrate: {}\n{}", reason.what, reason.remedy));
  return exit_failure;
}

/// It did not say how it ended. Where it may have turned it was stopped, as far as could be.
[[noreturn]] void give_up(const CalibrateOptions& options, const std::string& name, const RobotNow& robot,
                          const RobotNow& last, bool halted) {
  const std::string_view end = !last.may_turn() ? "it does not turn"
                               : halted         ? "it was stopped"
                                                : "it may still turn";
  if (robot.lost)
    fail({fmt::format("calibrate: {} is lost: {}", name,
                      robot.linked ? fmt::format("it has said nothing for its deadline; {}", end)
                                   : "its link is gone"),
          "a robot without a link stops; it can be connected again once it is near enough"});
  if (last.compass == Calibrator::Phase::none)
    fail({fmt::format("calibrate: the link to {} was gone for a while; a robot without a link stops", name),
          "say it again"});
  if (last.compass == Calibrator::Phase::asking)
    fail({fmt::format("calibrate: {} does not say how its compass is (asked {} times)", name,
                      last.compass_asked),
          "its program may be too old to calibrate by a command; or bring the central nearer"});
  fail({fmt::format("calibrate: {} has not said how it ended after {}; {}", name,
                    words::to_text(options.timeout), end),
        "give it more time: --timeout 180s"});
}

void run(const CalibrateOptions& options, int& exit_code) {
  using Phase = Calibrator::Phase;
  fleet::CentralLine line{"calibrate", options.line};
  const unsigned index = line.connect_one(options.robot);
  const std::string name = line.name(index);
  // A paused robot does not begin.
  const bool paused = !options.show && fleet::seems_paused(line, index);
  if (paused && !fleet::pause_until_seen(line, index, false))
    fail({fmt::format("calibrate: {} is paused, and does not go on", name), "amiroctl unpause says why"});

  if (const auto refused = line.end().calibrate(index, options.show)) {
    if (paused) fleet::pause_unseen(line, index);
    fail({fmt::format("calibrate: {}", refused->what), refused->remedy});
  }
  const auto overtaken = [&] { return !options.show && !line.end().is_ours(index); };
  const auto over = [&] {
    const RobotNow robot = line.robot(index);
    return robot.compass == Phase::none || robot.compass == Phase::done || robot.lost || overtaken();
  };
  const bool knows =
      line.run(answers_within, [&] { return over() || line.robot(index).compass != Phase::asking; });
  if (knows) (void)line.run(options.timeout, over);
  const RobotNow last = line.robot(index);  // a stop makes it void
  const bool done = last.compass == Phase::done;
  bool halted = true;
  if (last.may_turn() && !overtaken()) {
    (void)line.end().go(index, {});
    halted = line.halt({index});
  }
  if (paused && !overtaken() && (!done || interrupted() != 0)) fleet::pause_unseen(line, index);
  if (interrupted() != 0) throw Exit{exit_code_after_interrupt(exit_failure)};
  if (!done && overtaken())
    fail({fmt::format("calibrate: another program has stopped {} or sent it: {}", name, last.by),
          "calibrate it again once that is over"});
  if (!done) give_up(options, name, line.robot(index), last, halted);
  exit_code = report(name, last.calibration);
  if (paused && !fleet::pause_until_seen(line, index, true))
    remark(fmt::format("calibrate: {} was paused, and sends updates now", name));
}

}  // namespace

void declare_calibrate(Verb verb, Session&, int& exit_code) {
  verb.describe("turn a mapper around once for its compass, and say how good it is", mapper_group,
                "  amiroctl calibrate AVR\n"
                "  amiroctl calibrate AVR --show    how good the compass is, without a turn");
  const auto options = std::make_shared<CalibrateOptions>();
  verb.add_option("robot", options->robot, "its name, address or index").required().type_name("ROBOT");
  verb.add_flag("--show", options->show, "ask what it knows; it does not turn");
  add_lasting(verb, "--timeout", options->timeout, "then it is stopped");
  fleet::add_line_options(verb, options->line);
  verb.callback([options, &exit_code] { run(*options, exit_code); });
}

}  // namespace ocm::cli
