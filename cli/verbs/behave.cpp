#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "ocm/protocol/request.hpp"

#include "cli/command/behaviour_watch.hpp"
#include "cli/command/commanding.hpp"
#include "cli/command/operated_bus.hpp"
#include "cli/command/timeline.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/set_points.hpp"
#include "cli/shared/values.hpp"
#include "cli/verbs/verb.hpp"
#include "cli/words/value.hpp"

namespace ocm::cli {
namespace {

using Clock = Timeline::Clock;

constexpr base::Duration progress_period = std::chrono::milliseconds{100};
/// After so long without a sample the sensor is asked again.
constexpr base::Duration longest_silence = std::chrono::milliseconds{500};
/// After so long without a first sample this is said; it goes on, because the board may have heard all the
/// same.
constexpr base::Duration told_after = std::chrono::seconds{2};

constexpr const char* usual_speed = "0.1m/s";
constexpr const char* usual_distance = "5cm";

struct BehaveOptions {
  std::string which;
  std::string speed;     ///< empty: usual_speed
  std::string distance;  ///< empty: usual_distance
  std::optional<base::Duration> lasting;
  std::optional<protocol::Priority> priority;
  bool force = false;
  bool dry_run = false;
  bool no_confirm = false;
};

/// The set point of a behaviour with a speed and, where it has one, a distance; leaves with exit_usage where
/// an option has no such value, or no such field.
can::Frame set_point_of(const protocol::Topic& topic, const BehaveOptions& options) {
  std::vector<std::int64_t> raw;
  bool has_speed = false, has_distance = false;
  for (const protocol::Field& field : topic.frames[0].fields) {
    const bool is_speed = field.name == "speed";
    if (!is_speed && field.name != "distance")
      fail({fmt::format("behave: {} has a field {}, for which there is no option", topic.name, field.name),
            "is --spec that of the robot? Use set"});
    (is_speed ? has_speed : has_distance) = true;
    const std::string& given = is_speed ? options.speed : options.distance;
    const std::string usual = is_speed ? usual_speed : usual_distance;
    const auto value = words::parse_typed_value(field, given.empty() ? usual : given);
    if (!value)
      fail({"behave: " + value.error, is_speed ? "write 10cm/s or 0.1m/s" : "write 5cm or 0.05m"},
           exit_usage);
    if (is_speed && *value == 0)
      fail({"behave: --speed 0 goes nowhere", "`amiroctl behave none` ends what the boards do"}, exit_usage);
    raw.push_back(*value);
  }
  if (!has_speed)
    fail({fmt::format("behave: {} has no speed", topic.name), "is --spec that of the robot? Use set"});
  if (!has_distance && !options.distance.empty())
    fail({fmt::format("behave: {} takes no --distance", options.which), "drop --distance"}, exit_usage);
  return client::set_point(topic, raw, options.priority);
}

std::string remedy_for(const std::string& ended) {
  if (ended == "line_lost")
    return "put the robot on the line, or go more slowly: docs/behaviours.md has the least radius for a "
           "speed";
  if (ended == "no_sample") return "`amiroctl doctor` shows which part does not answer";
  if (ended == "late") return "streams take the board's time: `amiroctl stop`, then ask for slower ones";
  return "another program has commanded the robot";
}

/// Ends what any board does by itself.
client::Command none(const protocol::Catalogue& catalogue, const BehaveOptions& options) {
  client::Command command;
  for (const std::string_view name : {"avoid", "home", "follow", "travel"})
    if (const auto* topic = catalogue.find(name); topic != nullptr && topic->kind == protocol::Kind::actuator)
      command.frames.push_back(client::set_point(*topic, {}, options.priority));
  if (command.frames.empty()) static_cast<void>(behaviour_topic(catalogue, "behave", "avoid"));
  return command;
}

void behave(Session& session, const BehaveOptions& options, int& exit_code) {
  const std::string verb = "behave";
  const auto& catalogue = session.catalogue();
  const Confirm confirm = options.no_confirm ? Confirm::no : Confirm::yes;
  if (options.which == "none") {
    if (options.lasting) fail({"behave: none takes no --for", "drop --for"}, exit_usage);
    if (!options.speed.empty()) fail({"behave: none takes no --speed", "drop --speed"}, exit_usage);
    if (!options.distance.empty()) fail({"behave: none takes no --distance", "drop --distance"}, exit_usage);
    const auto command = none(catalogue, options);
    if (options.dry_run) return print_frames(command);
    const auto bus = open_to_command(session, verb);
    Timeline timeline{*bus, catalogue, verb, Timeline::Others::allowed, confirm, {}};
    timeline.carry_out_once(command);
    if (!timeline.finish()) exit_code = exit_failure;
    return;
  }
  if (options.which != "follow" && options.which != "avoid" && options.which != "home")
    fail({fmt::format("behave: unknown behaviour '{}'", options.which), "one of: follow, avoid, home, none"},
         exit_usage);
  const protocol::Topic& topic = behaviour_topic(catalogue, verb, options.which);
  client::Command command;
  command.hold = client::Hold{set_point_of(topic, options), client::set_point(topic, {}, options.priority),
                              options.lasting.value_or(base::Duration{})};
  command.frames = {command.hold->frame};
  if (options.dry_run) return print_frames(command);

  catch_interrupts();
  catch_hangups();
  catch_broken_pipe();
  // What the wheels' board does it reports; another board's commands to the wheels are what can be seen of
  // it.
  std::optional<BehaviourWatch> watch;
  if (options.which == "follow") watch.emplace(catalogue, verb, options.which);
  const client::FrameIndex index{catalogue};
  bool ended_by_another = false;
  const auto bus = open_to_command(session, verb);
  const auto others = options.force ? Timeline::Others::allowed : Timeline::Others::refused;
  Timeline timeline{*bus, catalogue, verb, others, confirm, [&](const can::Received& received) {
                      if (watch) watch->take(received);
                      const auto subject = index.subject(received.frame.id, received.frame.format);
                      if (subject.topic == &topic && subject.frame && is_rest(received.frame))
                        ended_by_another = true;
                      // The board follows without a word of the motors; one of another program ends it, and
                      // the next repetition would begin it again before the report of its end.
                      if (watch && subject.topic != nullptr && subject.topic->role == protocol::Role::drive)
                        ended_by_another = true;
                    }};
  bool goes_on =
      options.force ? timeline.wait(Clock::now() + client::listen_before_hold) : timeline.listen_first();
  if (!goes_on) {
    exit_code = exit_code_after_interrupt(exit_code);
    return;
  }
  timeline.expect_no_other();
  bool asked = watch && (!watch->heard() || timeline.has_asked());
  const auto ask = [&](const can::Frame& request) {
    client::Command command_of_one;
    command_of_one.frames = {request};
    timeline.carry_out_once(command_of_one);
  };
  const auto ask_progress = [&] {
    ask(protocol::encode({watch->sensor().id, protocol::Mode::publish,
                          *protocol::Period::from(progress_period), watch->sensor().priority}));
    asked = true;
  };
  const auto begun = Clock::now();
  const bool answered = watch && watch->heard();
  if (asked) ask_progress();
  if (watch) watch->begin();
  ended_by_another = false;
  timeline.carry_out(command);
  const auto end = options.lasting ? Clock::now() + *options.lasting : Clock::time_point::max();
  const auto over = [&] { return ended_by_another || (watch && watch->over()); };
  const auto unanswered = [&] {
    return transport::Failure{fmt::format("behave: no {} came, so nothing shows that {} has done it",
                                          watch->sensor().name, catalogue.board_name(topic)),
                              fmt::format("is board {} powered and on {}? See `amiroctl doctor`",
                                          catalogue.board_name(topic), bus->name())};
  };
  bool told = false;
  auto heard = Clock::now();  // or asked
  while (goes_on && !over() && Clock::now() < end) {
    goes_on = timeline.wait(std::min(end, Clock::now() + std::chrono::milliseconds{20}));
    if (!watch) continue;
    if (!told && !answered && !watch->heard() && Clock::now() - begun >= told_after) {
      told = true;
      remark(fmt::format("{}; {}", unanswered().what, unanswered().remedy));
    }
    heard = std::max(heard, watch->last());
    if (!goes_on || Clock::now() - heard < longest_silence) continue;
    ask_progress();  // a stop of everything ends this stream, too
    heard = Clock::now();
  }
  const bool early = over();
  const std::string how = watch && watch->is_replaced() ? "replaced by " + watch->commanded()
                          : watch && watch->over()      ? watch->ended()
                                                        : "stopped";
  timeline.rest();
  if (asked) ask(protocol::stop(watch->sensor().id, watch->sensor().priority));
  if (watch) timeline.leave_silence_to_caller();
  if (!timeline.finish()) exit_code = exit_failure;
  const bool could_answer = timeline.has_asked() || Clock::now() - begun >= longest_silence;
  if (watch && !answered && !watch->heard() && could_answer && goes_on && exit_code == exit_success)
    fail(unanswered());
  if (early) fail({fmt::format("behave: {} was ended: {}", options.which, how), remedy_for(how)});
  if (!goes_on) exit_code = exit_code_after_interrupt(exit_success);
}

}  // namespace

void add_behave(Verb app, Session& session, int& exit_code) {
  auto verb = app.add_verb(
      "behave", "let the boards follow a line, avoid obstacles or go to a wall by themselves", act_group,
      "  amiroctl behave follow                     until Ctrl-C, at 0.1 m/s\n"
      "  amiroctl behave avoid --speed 15cm/s --for 1min\n"
      "  amiroctl behave home --distance 5cm        to the nearest wall, and stays there\n"
      "  amiroctl behave none                       ends it, whichever program began it");
  const auto options = std::make_shared<BehaveOptions>();
  verb.add_option("which", options->which, "what to do").type_name("follow|avoid|home|none").required();
  verb.add_option("--speed", options->speed, "at most").type_name("V");
  verb.add_option("--distance", options->distance, "home: from the wall").type_name("X");
  add_lasting(verb, "--for", options->lasting, "how long");
  verb.add_flag("--force", options->force, "begin even if another program commands the motors");
  add_priority(verb, "--priority", options->priority,
               "urgent, high, medium or low, or 0 to 3; default: the topic's own");
  verb.add_flag("--dry-run", options->dry_run, "print the frames in candump notation and send nothing");
  add_no_confirm(verb, options->no_confirm);
  verb.callback([options, &session, &exit_code] { behave(session, *options, exit_code); });
}

}  // namespace ocm::cli
