#include <algorithm>
#include <chrono>
#include <memory>
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
#include "cli/shared/outgoing.hpp"
#include "cli/shared/values.hpp"
#include "cli/verbs/verb.hpp"
#include "cli/words/quantity.hpp"
#include "cli/words/value.hpp"

namespace ocm::cli {
namespace {

using Clock = Timeline::Clock;

/// So often the board says how far it is: the shortest travel takes some steps longer than that.
constexpr base::Duration progress_period = std::chrono::milliseconds{50};
/// After so long without a sample the sensor is asked again; a board that says nothing to several requests is
/// not there.
constexpr base::Duration longest_silence = std::chrono::milliseconds{300};
constexpr int most_asks = 3;

struct TravelOptions {
  std::string distance;
  std::string turn;
  std::string speed = "0.1m/s";
  std::optional<protocol::Priority> priority;
  bool force = false;
  bool dry_run = false;
  bool no_confirm = false;
};

/// The set point; leaves with exit_usage where a word is no value of its field.
can::Frame set_point_of(const protocol::Topic& topic, const TravelOptions& options) {
  const auto fields = topic.frames[0].fields;
  std::vector<std::int64_t> raw(fields.size());
  const auto put = [&](std::string_view name, const std::string& text, std::string_view remedy) {
    for (std::size_t i = 0; i < fields.size(); ++i) {
      if (fields[i].name != name) continue;
      const auto value = words::parse_typed_value(fields[i], text.empty() ? "0" : text);
      if (!value) fail({"travel: " + value.error, std::string{remedy}}, exit_usage);
      raw[i] = *value;
      return;
    }
    fail({fmt::format("travel: {} has no field {}", topic.name, name), "is --spec that of the robot?"});
  };
  put("distance", options.distance, "write 30cm, -0.3m or 50mm; an angle is --turn 90deg");
  put("angle", options.turn, "write 90deg or -1.57rad");
  put("speed", options.speed, "write 10cm/s or 0.1m/s");
  for (std::size_t i = 0; i < fields.size(); ++i)
    if (fields[i].name == "speed" && raw[i] == 0)
      fail({fmt::format("travel: --speed {} goes nowhere", options.speed),
            "write 10cm/s or 0.1m/s; `amiroctl behave none` ends what the boards do"},
           exit_usage);
  if (std::all_of(fields.begin(), fields.end(), [&](const protocol::Field& field) {
        return field.name == "speed" || raw[static_cast<std::size_t>(&field - fields.data())] == 0;
      }))
    fail({"travel: nowhere to go", "usage: amiroctl travel [DISTANCE] [--turn ANGLE], for example 30cm"},
         exit_usage);
  return client::set_point(topic, raw, options.priority);
}

std::string remedy_for(const std::string& ended) {
  if (ended == "too_long") return "is a wheel blocked? `amiroctl listen odom` shows whether they turn";
  if (ended == "no_sample") return "`amiroctl doctor` shows which part does not answer";
  if (ended == "late") return "streams take the board's time: `amiroctl stop`, then ask for slower ones";
  return "another program has commanded the robot; one that ended without a stop counts for 500 ms";
}

void travel(Session& session, const TravelOptions& options, int& exit_code) {
  const std::string verb = "travel";
  const auto& catalogue = session.catalogue();
  const protocol::Topic& topic = behaviour_topic(catalogue, verb, "travel");
  const can::Frame frame = set_point_of(topic, options);
  client::Command begin;
  begin.frames = {frame};
  if (options.dry_run) return print_frames(begin);

  catch_interrupts();
  catch_hangups();
  catch_broken_pipe();
  BehaviourWatch watch{catalogue, verb, "travel"};
  const auto bus = open_to_command(session, verb);
  const auto others = options.force ? Timeline::Others::allowed : Timeline::Others::refused;
  Timeline timeline{*bus,
                    catalogue,
                    verb,
                    others,
                    options.no_confirm ? Confirm::no : Confirm::yes,
                    [&watch](const can::Received& received) { watch.take(received); }};
  // The board travels without this program, which may be stopped and go on.
  const auto look = [&](base::Duration time) {
    const bool on = timeline.wait(Clock::now() + time);
    timeline.forgive_a_stop();
    return on;
  };
  // As long as it takes to hear other programs, and the sensor, if one has asked for it already.
  bool goes_on = options.force ? look(client::listen_before_hold) : timeline.listen_first();
  if (!goes_on) {
    exit_code = exit_code_after_interrupt(exit_code);
    return;
  }
  timeline.expect_no_other();
  const auto& sensor = watch.sensor();
  const can::Frame ask = protocol::encode(
      {sensor.id, protocol::Mode::publish, *protocol::Period::from(progress_period), sensor.priority});
  bool asked = !watch.heard() || timeline.has_asked();
  if (asked) begin.frames.insert(begin.frames.begin(), ask);
  watch.begin();
  timeline.expect_motion();
  const auto begun = Clock::now();
  timeline.carry_out_once(begin);
  auto heard = Clock::now();  // or asked
  bool silent = false;
  for (int asks = 0; goes_on && !watch.over() && !silent;) {
    goes_on = look(std::chrono::milliseconds{20});
    if (watch.last() > heard) {
      heard = watch.last();
      asks = 0;
    }
    if (Clock::now() - heard < longest_silence) continue;
    // A stop of everything ends this stream, too.
    silent = asks++ == most_asks;
    if (silent) break;
    client::Command again;
    again.frames = {ask};
    timeline.carry_out_once(again);
    asked = true;
    heard = Clock::now();
  }
  // Of two that begin at once neither has heard the other: both end, and no way is left that belongs to none.
  const bool together =
      watch.is_replaced() && !options.force && Clock::now() - begun < client::listen_before_hold;
  client::Command end;
  if (!watch.over() || together) end.frames.push_back(client::set_point(topic, {}, options.priority));
  if (asked) end.frames.push_back(protocol::stop(sensor.id, sensor.priority));
  timeline.forgive_a_stop();  // an end is never too late
  timeline.carry_out_once(end);
  if (silent) timeline.leave_silence_to_caller();
  const bool taken = timeline.finish();
  const std::string doctor = fmt::format("is board {} powered and on {}? See `amiroctl doctor`",
                                         catalogue.board_name(topic), bus->name());
  if (watch.is_replaced() && goes_on) {
    fail({fmt::format("travel: replaced by another program, {}; {} were left", watch.commanded(),
                      watch.left().empty() ? "all" : watch.left()),
          together ? "both began in the same moment, and were ended: give the command again, in one of them"
                   : "it was not ended: the robot does what came last"});
  } else if (!goes_on) {
    exit_code = exit_code_after_interrupt(exit_code);
  } else if (!taken) {
    exit_code = exit_failure;  // a board has refused it, which was said
  } else if (silent && watch.was_active()) {
    fail(
        {fmt::format("travel: {} has been silent for {}, so zeros were sent; {}", catalogue.board_name(topic),
                     words::to_text((most_asks + 1) * longest_silence), still_travelling),
         doctor});
  } else if (silent) {
    fail({fmt::format("travel: no {} within {}, so the travel was ended", sensor.name,
                      words::to_text((most_asks + 1) * longest_silence)),
          doctor});
  } else if (!watch.was_active()) {
    fail({fmt::format("travel: {} has not begun it", catalogue.board_name(topic)), remedy_for({})});
  } else if (watch.ended() != "arrived") {
    fail({fmt::format("travel: ended by {}: {}{}; {} are left", catalogue.board_name(topic), watch.ended(),
                      watch.commanded().empty() ? "" : " by " + watch.commanded(), watch.left()),
          remedy_for(watch.ended())});
  } else {
    fmt::print("arrived; {} are left\n", watch.left());
  }
}

}  // namespace

void add_travel(Verb app, Session& session, int& exit_code) {
  auto verb = app.add_verb("travel", "drive a distance, turn an angle, and say where that ended", act_group,
                           "  amiroctl travel 30cm                      ahead, at 0.1 m/s\n"
                           "  amiroctl travel -0.3m --turn 90deg        back, then turns to the left\n"
                           "  amiroctl travel --turn -90deg --speed 5cm/s");
  const auto options = std::make_shared<TravelOptions>();
  verb.add_option("distance", options->distance, "how far ahead; negative: back").type_name("[DISTANCE]");
  verb.add_option("--turn", options->turn, "then turns so far on the spot; to the left is positive")
      .type_name("ANGLE");
  verb.add_option("--speed", options->speed, "of the wheels").type_name("V");
  verb.add_flag("--force", options->force, "travel even if another program commands the motors");
  add_priority(verb, "--priority", options->priority,
               "urgent, high, medium or low, or 0 to 3; default: the topic's own");
  verb.add_flag("--dry-run", options->dry_run, "print the frame in candump notation and send nothing");
  add_no_confirm(verb, options->no_confirm);
  verb.callback([options, &session, &exit_code] { travel(session, *options, exit_code); });
}

}  // namespace ocm::cli
