#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "ocm/client/frame_index.hpp"
#include "ocm/protocol/request.hpp"

#include "cli/command/behaviour_watch.hpp"
#include "cli/command/commanding.hpp"
#include "cli/command/operated_bus.hpp"
#include "cli/command/timeline.hpp"
#include "cli/shared/behaviour_sensor.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/remedies.hpp"
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
constexpr base::Duration look_again = std::chrono::milliseconds{20};
/// After so long without a first sample this is said; a behaviour goes on, because the board may have heard
/// all the same.
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

  [[nodiscard]] Confirm confirm() const { return no_confirm ? Confirm::no : Confirm::yes; }
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

/// Nothing that a board should have sent came, so it may not have done what was commanded.
transport::Failure nothing_shows(std::string_view missing, std::string_view board,
                                 const transport::Bus& bus) {
  return {fmt::format("behave: no {} came, so nothing shows that {} has done it", missing, board),
          fmt::format("is board {} powered and on {}? See `amiroctl doctor`", board, bus.name())};
}

/// `none`: ends what any board does by itself, and hears what the wheels' board then does. The exit code;
/// leaves through cli::fail where that board says nothing.
int end_all(Session& session, const BehaveOptions& options) {
  if (options.lasting) fail({"behave: none takes no --for", "drop --for"}, exit_usage);
  if (!options.speed.empty()) fail({"behave: none takes no --speed", "drop --speed"}, exit_usage);
  if (!options.distance.empty()) fail({"behave: none takes no --distance", "drop --distance"}, exit_usage);
  const auto& catalogue = session.catalogue_on_bus(!options.dry_run);
  client::Command command;
  for (const std::string_view name : {"avoid", "home", "follow", "travel"})
    if (const auto* topic = catalogue.find(name); topic != nullptr && topic->kind == protocol::Kind::actuator)
      command.frames.push_back(client::set_point(*topic, {}, options.priority));
  if (command.frames.empty()) static_cast<void>(behaviour_topic(catalogue, "behave", "avoid"));
  if (options.dry_run) {
    print_frames(command);
    return exit_success;
  }
  const auto bus = open_to_command(session, "behave");
  const BehaviourSensor sensor{catalogue};
  const client::FrameIndex index{catalogue};
  bool heard = !sensor.exists() || options.no_confirm;
  if (!heard) command.frames.push_back(sensor.request());
  catch_interrupts();
  Timeline timeline{*bus,
                    catalogue,
                    "behave",
                    Timeline::Others::allowed,
                    options.confirm(),
                    [&](const can::Received& received) {
                      heard = heard || sensor.active_in(index, received.frame).has_value();
                    }};
  timeline.carry_out_once(command);
  timeline.leave_silence_to_caller();
  if (!timeline.finish()) return exit_failure;
  for (const auto end = Clock::now() + told_after; !heard && Clock::now() < end;)
    if (!timeline.wait(std::min(end, Clock::now() + look_again)))
      return exit_code_after_interrupt(exit_success);
  if (!heard) fail(nothing_shows(sensor.topic().name, catalogue.board_name(sensor.topic()), *bus));
  return exit_success;
}

/// A behaviour of a board, from listening for others to its end.
class Behaviour {
 public:
  Behaviour(Session& session, const BehaveOptions& options, const protocol::Catalogue& catalogue,
            const protocol::Topic& topic)
      : options_(&options),
        catalogue_(&catalogue),
        topic_(&topic),
        motors_(motors_of(catalogue)),
        index_(catalogue),
        watch_(watch_of(options, catalogue)),
        bus_(open_to_command(session, "behave")),
        timeline_(*bus_, catalogue, "behave",
                  options.force ? Timeline::Others::allowed : Timeline::Others::refused, options.confirm(),
                  [this](const can::Received& received) { take(received); }) {}

  /// The exit code. Leaves through cli::fail where another program or the board ended it, or where it is not
  /// known that the board has done it.
  [[nodiscard]] int carry_out(const client::Command& command) {
    if (!listen_first()) return exit_code_after_interrupt(exit_success);
    begin(command);
    follow();
    const bool early = over();
    const std::string how = how_it_ended();
    const bool taken = end();
    const bool could_answer = (watch_ && timeline_.has_asked()) || Clock::now() - begun_ >= longest_silence;
    if (unheard() && could_answer && goes_on_ && taken) fail(unanswered());
    if (early) fail({fmt::format("behave: {} was ended: {}", options_->which, how), remedy_for(how)});
    if (!goes_on_) return exit_code_after_interrupt(exit_success);
    return taken ? exit_success : exit_failure;
  }

 private:
  static const protocol::Topic* motors_of(const protocol::Catalogue& catalogue) {
    for (const protocol::Topic& topic : catalogue.topics)
      if (topic.role == protocol::Role::drive) return &topic;
    return nullptr;
  }

  /// What the wheels' board does it reports; another board's commands to the wheels are what can be seen of
  /// it.
  static std::optional<BehaviourWatch> watch_of(const BehaveOptions& options,
                                                const protocol::Catalogue& catalogue) {
    if (options.which != "follow") return std::nullopt;
    return BehaviourWatch{catalogue, "behave", options.which};
  }

  void take(const can::Received& received) {
    if (watch_) watch_->take(received);
    const auto subject = index_.subject(received.frame.id, received.frame.format);
    if (subject.topic == topic_ && subject.frame && is_rest(received.frame)) ended_by_another_ = true;
    if (subject.topic == nullptr || subject.topic->role != protocol::Role::drive) return;
    // The board follows without a word of the motors; one of another program ends it, and the next repetition
    // would begin it again before the report of its end.
    if (watch_) ended_by_another_ = true;
    commands_motors_ = true;
  }

  /// As long as it takes to hear other programs. False: a signal came first.
  [[nodiscard]] bool listen_first() {
    if (!(options_->force ? timeline_.wait(Clock::now() + client::listen_before_hold)
                          : timeline_.listen_first()))
      return false;
    timeline_.expect_no_other();
    return true;
  }

  void begin(const client::Command& command) {
    begun_ = Clock::now();
    answered_ = watch_ && watch_->heard();
    if (watch_ && (!watch_->heard() || timeline_.has_asked())) ask_progress();
    if (watch_) watch_->begin();
    ended_by_another_ = false;
    commands_motors_ = false;
    timeline_.carry_out(command);
  }

  /// Until its time is over, it has ended, or a signal comes.
  void follow() {
    const auto end =
        options_->lasting ? time_after(Clock::now(), *options_->lasting) : Clock::time_point::max();
    bool told = false;
    auto heard = Clock::now();  // or asked
    while (goes_on_ && !over() && Clock::now() < end) {
      goes_on_ = timeline_.wait(std::min(end, Clock::now() + look_again));
      if (!told && unheard() && Clock::now() - begun_ >= told_after) {
        told = true;
        const auto failure = unanswered();
        remark(fmt::format("{}; {}", failure.what, failure.remedy));
      }
      if (!watch_) continue;
      heard = std::max(heard, watch_->last());
      if (!goes_on_ || Clock::now() - heard < longest_silence) continue;
      ask_progress();  // a stop of everything ends this stream, too
      heard = Clock::now();
    }
  }

  /// Whether the boards took all.
  [[nodiscard]] bool end() {
    timeline_.rest();
    if (asked_) send(protocol::stop(watch_->sensor().id, watch_->sensor().priority));
    if (watch_) timeline_.leave_silence_to_caller();
    return timeline_.finish();
  }

  [[nodiscard]] bool over() const { return ended_by_another_ || (watch_ && watch_->over()); }
  /// Whether the board should have said something of it, or commanded the motors of another, and has not.
  [[nodiscard]] bool unheard() const {
    if (watch_) return !answered_ && !watch_->heard();
    return motors_ != nullptr && motors_->board != topic_->board && !commands_motors_;
  }

  [[nodiscard]] std::string how_it_ended() const {
    if (watch_ && watch_->is_replaced()) return "replaced by " + watch_->commanded();
    return watch_ && watch_->over() ? watch_->ended() : "stopped";
  }

  [[nodiscard]] transport::Failure unanswered() const {
    const auto board = catalogue_->board_name(*topic_);
    const std::string missing =
        watch_ ? std::string{watch_->sensor().name} : fmt::format("set point of {}", motors_->name);
    return nothing_shows(missing, board, *bus_);
  }

  void ask_progress() {
    send(protocol::encode({watch_->sensor().id, protocol::Mode::publish,
                           *protocol::Period::from(progress_period), watch_->sensor().priority}));
    asked_ = true;
  }

  void send(const can::Frame& request) {
    client::Command command;
    command.frames = {request};
    timeline_.carry_out_once(command);
  }

  const BehaveOptions* options_;
  const protocol::Catalogue* catalogue_;
  const protocol::Topic* topic_;
  const protocol::Topic* motors_;
  client::FrameIndex index_;
  std::optional<BehaviourWatch> watch_;
  std::unique_ptr<transport::Bus> bus_;
  Timeline timeline_;
  Clock::time_point begun_;
  bool answered_ = false;  ///< the board said what it does before it was asked
  bool asked_ = false;     ///< for what the board says of it
  bool goes_on_ = true;    ///< no signal came
  bool ended_by_another_ = false;
  bool commands_motors_ = false;  ///< the board, as far as can be seen; or another program
};

void behave(Session& session, const BehaveOptions& options, int& exit_code) {
  if (options.which == "none") {
    exit_code = end_all(session, options);
    return;
  }
  const auto& catalogue = session.catalogue_on_bus(!options.dry_run);
  if (options.which != "follow" && options.which != "avoid" && options.which != "home")
    fail({fmt::format("behave: unknown behaviour '{}'", options.which), "one of: follow, avoid, home, none"},
         exit_usage);
  const protocol::Topic& topic = behaviour_topic(catalogue, "behave", options.which);
  client::Command command;
  command.hold = client::Hold{set_point_of(topic, options), client::set_point(topic, {}, options.priority),
                              options.lasting.value_or(base::Duration{})};
  command.frames = {command.hold->frame};
  if (options.dry_run) return print_frames(command);
  catch_interrupts();
  catch_hangups();
  catch_broken_pipe();
  exit_code = Behaviour{session, options, catalogue, topic}.carry_out(command);
}

}  // namespace

void declare_behave(Verb verb, Session& session, int& exit_code) {
  verb.describe("let the boards follow a line, avoid obstacles or go to a wall by themselves", act_group,
                "  amiroctl behave follow                     until Ctrl-C, at 0.1 m/s\n"
                "  amiroctl behave avoid --speed 15cm/s --for 1min\n"
                "  amiroctl behave home --distance 5cm        to the nearest wall, and stays there\n"
                "  amiroctl behave none                       ends it, whichever program began it");
  const auto options = std::make_shared<BehaveOptions>();
  verb.add_option("which", options->which, "what to do").type_name("follow|avoid|home|none").required();
  verb.add_option("--speed", options->speed, fmt::format("at most; default: {}", usual_speed)).type_name("V");
  verb.add_option("--distance", options->distance,
                  fmt::format("home: from the wall; default: {}", usual_distance))
      .type_name("X");
  add_lasting(verb, "--for", options->lasting, "how long");
  verb.add_flag("--force", options->force, "begin even if another program commands the motors");
  add_priority(verb, "--priority", options->priority,
               "urgent, high, medium or low, or 0 to 3; default: the topic's own");
  verb.add_flag("--dry-run", options->dry_run, "print the frames in candump notation and send nothing");
  add_no_confirm(verb, options->no_confirm);
  verb.callback([verb, options, &session, &exit_code] {
    // What a config file has for others is none of theirs.
    const bool ends = options->which == "none";
    if (ends && !verb.is_typed("--for")) options->lasting.reset();
    if (ends && !verb.is_typed("--speed")) options->speed.clear();
    if (options->which != "home" && !verb.is_typed("--distance")) options->distance.clear();
    behave(session, *options, exit_code);
  });
}

}  // namespace ocm::cli
