#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <string_view>
#include <unistd.h>
#include <vector>

#include <fmt/format.h>

#include "ocm/can/text.hpp"
#include "ocm/client/frame_index.hpp"

#include "cli/command/commanding.hpp"
#include "cli/command/operated_bus.hpp"
#include "cli/command/timeline.hpp"
#include "cli/logs/file_source.hpp"
#include "cli/output/printer.hpp"
#include "cli/shared/begun_behaviours.hpp"
#include "cli/shared/clock.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/terminal.hpp"
#include "cli/shared/unhurried_messages.hpp"
#include "cli/verbs/verb.hpp"
#include "cli/words/quantity.hpp"
#include "cli/words/script.hpp"

namespace ocm::cli {
namespace {

struct RunOptions {
  std::string file;
  double speed = 1;
  bool show = false;
  bool force = false;
  bool no_confirm = false;
  bool dry_run = false;
};

/// Far more than a person writes by hand; a pipe that never ends must not fill the memory.
constexpr std::size_t max_script = 16U << 20U;

std::string read_script(const std::string& file) {
  auto [text, failure, too_long] = logs::read_file(file, max_script);
  const std::string name = file == "-" ? "the standard input" : file;
  if (!failure.empty())
    fail({fmt::format("cannot read {}: {}", name, failure),
          "give the name of a script, or - for standard input"});
  if (too_long)
    fail({fmt::format("{} is larger than {} MiB", name, max_script >> 20U),
          "a script has one command a line"});
  if (const auto at = text.find('\0'); at != std::string::npos)
    fail({fmt::format("{} is no text: line {} has a byte of zero", name,
                      std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n') + 1),
          "a script has one command a line"},
         exit_usage);
  return std::move(text);
}

/// The script, checked whole: with an error in it nothing is sent.
words::Script checked(const std::string& file, const std::string& text,
                      const protocol::Catalogue& catalogue) {
  auto script = words::parse_script(text, catalogue);
  if (script.errors.empty()) return script;
  const std::size_t told = std::min(script.errors.size(), words::most_explained);  // the rest are counted
  for (const auto& error : std::span{script.errors}.first(told))
    remark(fmt::format("{}:{}:{}: {}\n    {}", file, error.line, error.column, error.what, error.remedy));
  if (told < script.errors.size()) remark(fmt::format("... and {} more", script.errors.size() - told));
  fail({fmt::format("{}: {}, nothing was sent", file, counted(script.errors.size(), "error")), ""},
       exit_usage);
}

/// When a step is due, from the start.
Timeline::Clock::duration due(const words::Step& step, double speed) {
  const double scaled = static_cast<double>(step.at.count()) / speed;
  const auto longest = Timeline::Clock::duration::max();
  return scaled < static_cast<double>(longest.count()) ? Timeline::Clock::duration{std::llround(scaled)}
                                                       : longest;
}

/// When the first drive is due, from the start; nothing: there is none.
std::optional<base::Duration> first_drive(const words::Script& script, double speed) {
  for (const auto& step : script.steps)
    if (step.command.hold) return due(step, speed);
  return std::nullopt;
}

/// How long before the first drive a board is asked what it does by itself, where it has not said so.
constexpr base::Duration asks_before = std::chrono::milliseconds{100};

/// What is sent again and again behind these steps, by name.
std::vector<std::string_view> repeated_after(std::span<const words::Step> steps,
                                             const protocol::Catalogue& catalogue) {
  const client::FrameIndex index{catalogue};
  std::vector<std::string_view> names;
  for (const auto& step : steps) {
    const auto note = [&](const protocol::Topic& topic) {
      std::erase(names, topic.name);
      if (step.command.repeat && step.command.repeat->lasting.count() == 0) names.push_back(topic.name);
    };
    if (step.command.broadcast) {
      note(*step.command.broadcast->message);
      continue;
    }
    step.command.each_frame([&](const can::AnyFrame& frame) {
      if (const auto subject = index.subject(frame.id, frame.format)) note(*subject.topic);
    });
  }
  return names;
}

/// Whether the motors are held behind these steps, without end.
bool holds_after(std::span<const words::Step> steps) {
  bool holds = false;
  for (const auto& step : steps)
    if (step.command.hold || step.command.ends_hold)
      holds = step.command.hold && step.command.hold->lasting.count() == 0;
  return holds;
}

/// What an interrupted script leaves, of the steps that it has carried out. `ended`: what boards did by
/// themselves.
std::string left_by(std::span<const words::Step> steps, const protocol::Catalogue& catalogue,
                    const BegunBehaviours& ended) {
  const auto any = [steps](auto is) {
    return std::any_of(steps.begin(), steps.end(), [&](const words::Step& each) { return is(each.command); });
  };
  std::vector<std::string> left;
  if (any([](const client::Command& each) { return each.hold.has_value(); }))
    left.emplace_back("the motors were set to zero");
  if (!ended.all().empty()) left.push_back(ended.names() + " ended");
  auto names = repeated_after(steps, catalogue);
  for (const auto& each : ended.all()) std::erase(names, each.topic->name);
  if (!names.empty())
    left.push_back(fmt::format("{} {} no longer sent, and what was sent last holds", fmt::join(names, ", "),
                               names.size() == 1 ? "is" : "are"));
  if (any([](const client::Command& each) { return each.answers != nullptr; }))
    left.emplace_back("`amiroctl stop` stops the sensors too");
  return left.empty() ? "interrupted" : fmt::format("interrupted: {}", fmt::join(left, "; "));
}

/// What the robot says meanwhile, for --show.
class Answers {
 public:
  Answers(const Session& session, const protocol::Catalogue& catalogue, std::string_view bus)
      : bus_(bus),
        receiver_(catalogue),
        printer_(make_output(isatty(STDOUT_FILENO) != 0 ? Format::pretty : Format::json, catalogue, {},
                             session.colour(), columns_of_output)) {}

  /// What comes before that is for the script, which listens for another commander.
  void begin() { shows_ = true; }

  void show(const can::Received& received) {
    if (!shows_) return;
    const auto reception = receiver_.take(received);
    if (reception.meaning == client::Meaning::request || reception.meaning == client::Meaning::set_point)
      return;
    shows_ = false;               // a failure ends this: what stops the robot then hears frames, too
    if (!printer_.flush_now()) {  // the next step waits for no reader
      ++hidden_;
    } else {
      printer_.write({bus_, log::Entry{received.time, received.frame}, reception});
      static_cast<void>(printer_.flush_now());
    }
    shows_ = true;
  }

  /// Writes the rest of a line, for which its reader has a second; says how many were not shown. Leaves
  /// through cli::fail where stdout takes no more.
  void finish() {
    bool whole = printer_.flush_now();
    for (int looks = 0; looks < 10 && !whole; ++looks) {
      sleep_for(std::chrono::milliseconds{100});
      whole = printer_.flush_now();
    }
    if (!whole) ++hidden_;
    if (hidden_ != 0) remark(fmt::format("run: {} not shown: stdout took none", counted(hidden_, "answer")));
  }

 private:
  std::string bus_;
  client::Receiver receiver_;
  Printer printer_;
  bool shows_ = false;
  std::uint64_t hidden_ = 0;
};

/// A script that is carried out on the bus.
class ScriptRun {
 public:
  ScriptRun(Session& session, const RunOptions& options, const protocol::Catalogue& catalogue,
            const words::Script& script)
      : catalogue_(&catalogue),
        steps_(script.steps),
        speed_(options.speed),
        drives_(first_drive(script, options.speed)),
        bus_(open_to_command(session, "run")),
        answers_(session, catalogue, bus_->name()),
        timeline_(
            *bus_, catalogue, "run", options.force ? Timeline::Others::allowed : Timeline::Others::refused,
            options.no_confirm ? Confirm::no : Confirm::yes,
            options.show ? std::function{[this](const can::Received& received) { answers_.show(received); }}
                         : std::function<void(const can::Received&)>{}),
        behaviours_(catalogue) {}

  /// The exit code. Leaves through cli::fail where a step cannot be carried out; what boards do by themselves
  /// because of earlier ones is ended then, as after a signal.
  [[nodiscard]] int carry_out() {
    listen_first();
    bool whole = false;
    try {
      whole = carry_out_steps() && wait_for_end();
    } catch (...) {  // the error is said, or main says it
      if (bus_->state() == transport::BusState::closed) throw;
      end_behaviours();
      if (!behaviours_.all().empty() && timeline_.finish()) remark(behaviours_.names() + " ended");
      throw;
    }
    if (!whole) end_behaviours();
    int exit_code = timeline_.finish() ? exit_success : exit_failure;
    if (whole && interrupted() != 0) {  // while it listened for answers
      whole = false;
      end_behaviours();
      static_cast<void>(timeline_.finish());
    }
    if (!whole) {
      remark(left_by(done(), *catalogue_, behaviours_));
      exit_code = exit_code_after_interrupt(exit_success);
    }
    answers_.finish();
    return exit_code;
  }

 private:
  /// So long that another program that commands the motors is heard before the first drive.
  void listen_first() {
    if (drives_ && *drives_ < client::listen_before_hold)
      static_cast<void>(timeline_.listen_first(client::listen_before_hold - *drives_));  // signals: see below
    answers_.begin();
  }

  /// Whether all of them were.
  [[nodiscard]] bool carry_out_steps() {
    const auto start = Timeline::Clock::now();
    bool asks = drives_ && *drives_ > asks_before && !timeline_.has_asked();
    for (const auto& step : steps_) {
      if (asks && due(step, speed_) > *drives_ - asks_before) {
        if (!timeline_.wait_for_step(time_after(start, *drives_ - asks_before))) return false;
        timeline_.ask();
        asks = false;
      }
      if (!timeline_.wait_for_step(time_after(start, due(step, speed_)))) return false;
      remark(fmt::format("{:>8}  {}", words::to_text(step.at), step.text));
      ++begun_;
      timeline_.carry_out(step.command);
    }
    return interrupted() == 0;
  }

  /// Of what the steps have begun; says what has none. Whether no signal came.
  [[nodiscard]] bool wait_for_end() {
    if (const auto names = repeated_after(steps_, *catalogue_); !names.empty())
      remark(fmt::format("run: {} {} sent until Ctrl-C; --for ends that", fmt::join(names, ", "),
                         names.size() == 1 ? "is" : "are"));
    if (holds_after(steps_))
      remark("run: the drive goes on until Ctrl-C; --for, or a last step `drive stop`, ends it");
    return interrupted() == 0 && timeline_.wait_for_end();
  }

  /// Ends what boards do by themselves because of the steps; leaves through cli::fail if the end cannot be
  /// sent.
  void end_behaviours() {
    for (const auto& step : done())
      step.command.each_frame([&](const can::AnyFrame& frame) {
        if (const auto classic = frame.classic()) behaviours_.sent(*classic);
      });
    client::Command end;
    for (const auto& each : behaviours_.all()) end.frames.push_back(each.end);
    if (end.frames.empty()) return;
    timeline_.forgive_a_stop();  // an end is never too late
    timeline_.carry_out_once(end);
  }

  [[nodiscard]] std::span<const words::Step> done() const { return steps_.first(begun_); }

  const protocol::Catalogue* catalogue_;
  std::span<const words::Step> steps_;
  double speed_;
  std::optional<base::Duration> drives_;  ///< when the first drive is due, from the start
  std::unique_ptr<transport::Bus> bus_;
  Answers answers_;
  Timeline timeline_;
  BegunBehaviours behaviours_;
  std::size_t begun_ = 0;  ///< steps, the last one perhaps in part
};

/// What each step sends, and when.
void print_frames(const words::Script& script) {
  for (const auto& step : script.steps)
    step.command.each_frame([&](const can::AnyFrame& frame) {
      fmt::print("{:<8} {}\n", words::to_text(step.at), can::to_text(frame).view());
    });
}

void run(Session& session, const RunOptions& options, int& exit_code) {
  const auto& catalogue = session.catalogue_on_bus(!options.dry_run);
  const auto script = checked(options.file, read_script(options.file), catalogue);
  if (options.dry_run) {
    print_frames(script);
    return;
  }
  catch_interrupts();
  catch_hangups();
  catch_broken_pipe();
  exit_code = ScriptRun{session, options, catalogue, script}.carry_out();
}

}  // namespace

void declare_run(Verb verb, Session& session, int& exit_code) {
  verb.describe("carry out a script, each line at its time", play_group,
                "  amiroctl run examples/standalone.script --show\n"
                "  amiroctl run tour.script --speed 10\n"
                "  echo '0s drive 5cm/s --for 1s' | amiroctl run -");
  const auto options = std::make_shared<RunOptions>();
  verb.add_option("script", options->file, "file, or - for standard input")
      .required()
      .type_name("SCRIPT")
      .in_usage("SCRIPT|-");
  verb.add_option("--speed", options->speed, "how many times faster the steps follow each other")
      .range(0.001, 1000.0)
      .type_name("N");
  verb.add_flag("--show,--listen", options->show, "show what the sensors answer").formerly("--listen");
  verb.add_flag("--force", options->force, "drive even if another program commands the motors");
  add_no_confirm(verb, options->no_confirm);
  verb.add_flag("--dry-run", options->dry_run, "print each step's frames and send nothing");
  verb.callback([options, &session, &exit_code] { run(session, *options, exit_code); });
}

}  // namespace ocm::cli
