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
#include "cli/output/printer.hpp"
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

/// A travel, from listening for others to its end.
class Travel {
 public:
  Travel(Session& session, const TravelOptions& options, const protocol::Catalogue& catalogue,
         const protocol::Topic& topic)
      : options_(&options),
        catalogue_(&catalogue),
        topic_(&topic),
        watch_(catalogue, "travel", "travel"),
        bus_(open_to_command(session, "travel")),
        timeline_(*bus_, catalogue, "travel",
                  options.force ? Timeline::Others::allowed : Timeline::Others::refused,
                  options.no_confirm ? Confirm::no : Confirm::yes,
                  [this](const can::Received& received) { watch_.take(received); }) {}

  /// The exit code. Leaves through cli::fail where it did not arrive.
  [[nodiscard]] int carry_out(const can::Frame& set_point) {
    if (!listen_first()) return exit_code_after_interrupt(exit_success);
    try {
      if (sees()) {
        begin(set_point);
        follow();
      }
    } catch (...) {  // the error is said, or main says it
      give_up();
      throw;
    }
    const bool taken = end();
    if (!begun_ && silent_) fail(not_begun());
    if (!begun_ && goes_on_) {  // refused, which was said
      remark("travel: not begun: nothing would tell how far it is");
      return exit_failure;
    }
    if (watch_.is_replaced() && goes_on_) fail(replaced());
    if (!goes_on_) return exit_code_after_interrupt(exit_success);
    if (!taken) return exit_failure;  // a board has refused it, which was said
    if (silent_ || !watch_.was_active() || watch_.ended() != "arrived") fail(not_arrived());
    write_out(fmt::format("arrived; {} are left\n", watch_.left()));
    return exit_success;
  }

 private:
  /// As long as it takes to hear other programs, and the sensor, if one has asked for it already. False: a
  /// signal came first.
  [[nodiscard]] bool listen_first() {
    if (!(options_->force ? timeline_.wait(Clock::now() + client::listen_before_hold)
                          : timeline_.listen_first()))
      return false;
    timeline_.expect_no_other();
    return true;
  }

  /// Whether samples come that tell of the travel: without them a robot would move unseen. False: they are
  /// refused, the board is silent, or a signal comes. A program that was stopped meanwhile leaves before the
  /// set point: nothing is forgiven here.
  [[nodiscard]] bool sees() {
    asked_ = !watch_.heard() || timeline_.has_asked();
    for (int asks = 0; asked_ && asks <= most_asks; ++asks) {
      client::Command first;
      first.frames = {ask()};
      const auto since = Clock::now();
      timeline_.carry_out_once(first);
      while (watch_.last() <= since && Clock::now() - since < longest_silence) {
        goes_on_ = timeline_.wait(Clock::now() + std::chrono::milliseconds{10});
        if (!goes_on_ || timeline_.has_refused()) return false;
      }
      if (watch_.last() > since) return true;
    }
    silent_ = asked_;
    return !silent_;
  }

  void begin(const can::Frame& set_point) {
    timeline_.expect_no_other();  // that began meanwhile
    if (watch_.is_replaced() && !options_->force)
      fail({fmt::format("travel: another program has just begun {}", watch_.commanded()),
            "wait for its end, or `amiroctl behave none`; --force begins all the same, and ends it"});
    client::Command begin;
    begin.frames = {set_point};
    watch_.begin();
    timeline_.expect_motion();
    begun_ = Clock::now();
    timeline_.carry_out_once(begin);
  }

  /// Until it is over, the board is silent, or a signal comes.
  void follow() {
    auto heard = Clock::now();  // or asked
    for (int asks = 0; goes_on_ && !watch_.over();) {
      goes_on_ = look(std::chrono::milliseconds{20});
      if (watch_.last() > heard) {
        heard = watch_.last();
        asks = 0;
      }
      if (Clock::now() - heard < longest_silence) continue;
      silent_ = asks++ == most_asks;
      if (silent_) return;
      // A stop of everything ends this stream, too.
      client::Command again;
      again.frames = {ask()};
      timeline_.carry_out_once(again);
      asked_ = true;
      heard = Clock::now();
    }
  }

  /// Whether the boards took all.
  [[nodiscard]] bool end() {
    together_ = begun_ && watch_.is_replaced() && !options_->force &&
                Clock::now() - *begun_ < client::listen_before_hold;
    client::Command end;
    // Samples of before it was heard may have said that it is not active: it may begin after them.
    const bool is_over = watch_.is_replaced() || (watch_.over() && watch_.was_active());
    if (begun_ && (!is_over || together_))
      end.frames.push_back(client::set_point(*topic_, {}, options_->priority));
    const bool streams = asked_ && (begun_ || !timeline_.has_refused());
    if (streams) end.frames.push_back(protocol::stop(watch_.sensor().id, watch_.sensor().priority));
    timeline_.forgive_a_stop();  // an end is never too late
    timeline_.carry_out_once(end);
    if (silent_) timeline_.leave_silence_to_caller();
    return timeline_.finish();
  }

  /// What was not taken may have been sent all the same: an operator may die between frame and answer.
  void give_up() {
    if (bus_->state() == transport::BusState::closed) return;
    client::Command end;
    if (begun_) end.frames = {client::set_point(*topic_, {}, options_->priority)};
    if (asked_) end.frames.push_back(protocol::stop(watch_.sensor().id, watch_.sensor().priority));
    timeline_.forgive_a_stop();
    timeline_.carry_out_once(end);
    if (timeline_.finish() && begun_) remark("travel: zeros were sent, which end it");
  }

  [[nodiscard]] transport::Failure replaced() const {
    return {fmt::format("travel: replaced by another program, {}; {} were left", watch_.commanded(),
                        watch_.left().empty() ? "all" : watch_.left()),
            together_
                ? "both began in the same moment, and were ended: give the command again, in one of them"
                : "it was not ended: the robot does what came last"};
  }

  [[nodiscard]] transport::Failure not_begun() const {
    return {fmt::format("travel: no {} within {}, so the travel was not begun", watch_.sensor().name,
                        words::to_text((most_asks + 1) * longest_silence)),
            is_it_there() + (options_->no_confirm ? "; with --no-confirm no refusal is heard" : "")};
  }

  [[nodiscard]] std::string is_it_there() const {
    return fmt::format("is board {} powered and on {}? See `amiroctl doctor`",
                       catalogue_->board_name(*topic_), bus_->name());
  }

  [[nodiscard]] transport::Failure not_arrived() const {
    const auto board = catalogue_->board_name(*topic_);
    if (silent_) {
      const std::string time = words::to_text((most_asks + 1) * longest_silence);
      return {watch_.was_active() ? fmt::format("travel: {} has been silent for {}, so zeros were sent; {}",
                                                board, time, still_travelling)
                                  : fmt::format("travel: no {} within {}, so the travel was ended",
                                                watch_.sensor().name, time),
              is_it_there()};
    }
    if (!watch_.was_active()) return {fmt::format("travel: {} has not begun it", board), remedy_for({})};
    return {fmt::format("travel: ended by {}: {}{}; {} are left", board, watch_.ended(),
                        watch_.commanded().empty() ? "" : " by " + watch_.commanded(), watch_.left()),
            remedy_for(watch_.ended())};
  }

  /// Whether no signal came. The board travels without this program, which may be stopped and go on.
  [[nodiscard]] bool look(base::Duration time) {
    const bool on = timeline_.wait(Clock::now() + time);
    timeline_.forgive_a_stop();
    return on;
  }

  [[nodiscard]] can::Frame ask() const {
    const protocol::Topic& sensor = watch_.sensor();
    return protocol::encode(
        {sensor.id, protocol::Mode::publish, *protocol::Period::from(progress_period), sensor.priority});
  }

  const TravelOptions* options_;
  const protocol::Catalogue* catalogue_;
  const protocol::Topic* topic_;
  BehaviourWatch watch_;
  std::unique_ptr<transport::Bus> bus_;
  Timeline timeline_;
  std::optional<Clock::time_point> begun_;  ///< when the set point was sent
  bool asked_ = false;                      ///< for what the board says of it
  bool goes_on_ = true;                     ///< no signal came
  bool silent_ = false;                     ///< the board does not answer
  bool together_ = false;  ///< another began in the same moment: neither has heard the other, so both end
};

void travel(Session& session, const TravelOptions& options, int& exit_code) {
  const auto& catalogue = session.catalogue_on_bus(!options.dry_run);
  const protocol::Topic& topic = behaviour_topic(catalogue, "travel", "travel");
  const can::Frame set_point = set_point_of(topic, options);
  if (options.dry_run) {
    client::Command command;
    command.frames = {set_point};
    return print_frames(command);
  }
  catch_interrupts();
  catch_hangups();
  catch_broken_pipe();
  exit_code = Travel{session, options, catalogue, topic}.carry_out(set_point);
}

}  // namespace

void declare_travel(Verb verb, Session& session, int& exit_code) {
  verb.describe("drive a distance, turn an angle, and say where that ended", act_group,
                "  amiroctl travel 30cm                      ahead, at 0.1 m/s\n"
                "  amiroctl travel -0.3m --turn 90deg        back, then turns to the left\n"
                "  amiroctl travel --turn -90deg --speed 5cm/s");
  const auto options = std::make_shared<TravelOptions>();
  verb.add_option("distance", options->distance, "how far ahead; negative: back").type_name("[DISTANCE]");
  verb.add_option("--turn", options->turn, "then turns so far on the spot; to the left is positive")
      .type_name("ANGLE");
  verb.add_option("--speed", options->speed, "of the wheels").type_name("V").show_default();
  verb.add_flag("--force", options->force, "travel even if another program commands the motors");
  add_priority(verb, "--priority", options->priority,
               "urgent, high, medium or low, or 0 to 3; default: the topic's own");
  verb.add_flag("--dry-run", options->dry_run, "print the frame in candump notation and send nothing");
  add_no_confirm(verb, options->no_confirm);
  verb.callback([options, &session, &exit_code] { travel(session, *options, exit_code); });
}

}  // namespace ocm::cli
