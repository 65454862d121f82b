#include <memory>
#include <string>

#include "cli/command/commanding.hpp"
#include "cli/command/drive_by_pad.hpp"
#include "cli/command/key_drive.hpp"
#include "cli/command/operated_bus.hpp"
#include "cli/command/timeline.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/values.hpp"
#include "cli/verbs/verb.hpp"

namespace ocm::cli {

void declare_drive(Verb verb, Session& session, int& exit_code) {
  verb.describe("set the motors, and keep them going until Ctrl-C or --for", act_group,
                "  amiroctl drive 0.05m/s 0.2rad/s       until Ctrl-C, then zero\n"
                "  amiroctl drive 5cm/s -30deg/s --for 2s\n"
                "  amiroctl drive 0 30deg/s              turns on the spot; only zero needs no unit\n"
                "  amiroctl drive --keys                 while an arrow key is held; q quits\n"
                "  amiroctl drive --gamepad /dev/input/event5\n"
                "  amiroctl drive stop");
  struct Options {
    Options(Verb app, Session& s)
        : commanding(app, s, "forward velocity X, angular velocity Z (left is positive); stop: zero") {}
    Commanding commanding;
    bool once = false;
    bool force = false;
    bool keys = false;
    std::string gamepad;
  };
  const auto options = std::make_shared<Options>(verb, session);
  const auto lasting = add_lasting(verb, "--for", options->commanding.options().lasting, "how long to drive");
  const auto once =
      verb.add_flag("--once", options->once, "send one frame; the board stops the motors when none follows")
          .excludes(lasting);
  const auto keys =
      verb.add_flag(
              "--keys", options->keys,
              "drive while a key is held: arrows, or u i o j l m , . as in teleop; X and Z are the speeds")
          .excludes(lasting)
          .excludes(once)
          .excludes(verb.option("--dry-run"));
  verb.add_option(
          "--gamepad", options->gamepad,
          "drive by the left stick of a gamepad while a shoulder button is held; X and Z are its ends")
      .type_name("DEVICE")
      .excludes(keys)
      .excludes(lasting)
      .excludes(once)
      .excludes(verb.option("--dry-run"));
  verb.add_flag("--force", options->force, "drive even if another program commands the motors");
  verb.callback([verb, options, &session, &exit_code] {
    const auto& words = options->commanding.words();
    if (!words.empty() && words[0] == "stop") {  // what a config file has is for driving
      if (!verb.is_typed("--for")) options->commanding.options().lasting.reset();
      if (!verb.is_typed("--keys")) options->keys = false;
      if (!verb.is_typed("--gamepad")) options->gamepad.clear();
    }
    const auto others = options->force ? Timeline::Others::allowed : Timeline::Others::refused;
    if (options->keys) {
      exit_code = drive_by_keys(session, {options->commanding.words(), options->commanding.options(), others,
                                          options->commanding.confirm()});
      return;
    }
    if (!options->gamepad.empty()) {
      exit_code =
          drive_by_pad(session, {options->gamepad, options->commanding.words(), options->commanding.options(),
                                 others, options->commanding.confirm()});
      return;
    }
    const auto command = options->commanding.parse();
    if (options->commanding.dry_run() || !command.hold)
      return carry_out(session, options->commanding, command);
    catch_interrupts();
    catch_hangups();
    catch_broken_pipe();
    const auto bus = open_to_command(session, "drive");
    const Commanding& commanding = options->commanding;
    Timeline timeline{*bus, commanding.catalogue(), "drive", others, commanding.confirm(), {}};
    if (timeline.listen_first()) {
      if (options->once) {
        timeline.carry_out_once(command);
      } else {
        timeline.carry_out(command);
        static_cast<void>(timeline.wait_for_end());
      }
    }
    if (!timeline.finish()) exit_code = exit_failure;
    exit_code = exit_code_after_interrupt(exit_code);  // also of a signal behind the end
  });
}

}  // namespace ocm::cli
