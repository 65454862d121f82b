#include "cli/command/commanding.hpp"

#include <memory>

#include <fmt/format.h>

#include "ocm/can/any_text.hpp"

#include "cli/command/operated_bus.hpp"
#include "cli/command/presence_watch.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/live.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/outgoing.hpp"
#include "cli/shared/set_points.hpp"
#include "cli/shared/unhurried_messages.hpp"
#include "cli/shared/values.hpp"
#include "cli/words/quantity.hpp"

namespace ocm::cli {

Commanding::Commanding(Verb verb, Session& session, std::string_view words_help, Sends sends)
    : verb_(verb.name()), session_(&session) {
  verb.add_option("words", words_, std::string{words_help})
      .type_name("")
      .in_usage(std::string{words::form_of(verb_)});
  raw_ = sends == Sends::raw_frames;
  if (!raw_)
    add_priority(verb, "--priority", options_.priority,
                 "urgent, high, medium or low, or 0 to 3; default: the topic's own");
  verb.add_flag("--dry-run", dry_run_, "print the frames in candump notation and send nothing");
  if (sends == Sends::commands) add_no_confirm(verb, no_confirm_);
  if (sends == Sends::requests)
    verb.add_flag(
        "--no-confirm", no_confirm_,
        "end when the request has left; default: when the first sample shows that the board heard it");
}

client::Command Commanding::parse() const {
  std::vector<std::string_view> words{verb_};
  words.insert(words.end(), words_.begin(), words_.end());
  auto command = words::CommandParser{catalogue(), "amiroctl "}.parse(words, options_);
  if (!command) fail({verb_ + ": " + command.error.what, command.error.remedy}, exit_usage);
  return std::move(command.value);
}

void print_frames(const client::Command& command) {
  command.each_frame([](const can::AnyFrame& frame) { fmt::print("{}\n", can::to_text(frame).view()); });
}

void add_no_confirm(Verb verb, bool& no_confirm) {
  verb.add_flag(
      "--no-confirm", no_confirm,
      fmt::format("end when all has left; default: ask whether the board is there, and listen for its "
                  "refusal for {}",
                  words::to_text(client::refusal_patience)));
}

void carry_out(Session& session, const Commanding& commanding, const client::Command& command) {
  const auto& frames = command.frames;
  if (commanding.dry_run()) return print_frames(command);
  never_wait_for_messages();
  // A stop goes to the robot at once, and so does a frame that is sent as it is.
  const std::string& verb = commanding.verb();
  const bool guarded = verb == "drive" || verb == "led" || verb == "set";
  const auto bus = guarded ? open_to_command(session, verb) : session.open_bus();
  RefusalWatch refusals{commanding.catalogue(), verb, commanding.confirm()};
  PresenceWatch presence{commanding.catalogue(), verb, commanding.confirm()};
  presence.sent(command);
  refusals.prepare(*bus, frames, presence.signs());
  const char* const otherwise = command.ends_hold                              ? still_moving
                                : ends_travel(commanding.catalogue(), command) ? still_travelling
                                                                               : "";
  Outgoing outgoing{*bus, verb, otherwise};
  command.each_frame([&](const can::AnyFrame& frame) { outgoing.send(frame); });
  outgoing.expect_all_left();
  refusals.sent(frames);
  refusals.listen(*bus, [&](const can::Received& received) { presence.take(received); });
  catch_interrupts();  // the wait is long enough for one
  presence.ask(*bus, outgoing);
  Live live{*bus};
  const Over over = presence.listen(live, [&](const can::Received& received) {
    presence.take(received);
    refusals.take(received);
  });
  if (command.ends_hold) refusals.forgive_unserved();
  const bool silent = presence.tell(otherwise);
  refusals.leave_if_refused();
  if (silent || over == Over::signal) throw Exit{exit_code_after_interrupt(exit_failure)};
}

void declare_command_verb(Verb verb, Session& session, std::string_view description, std::string_view group,
                          std::string_view words_help, std::string_view examples) {
  verb.describe(description, group, examples);
  const auto commanding = std::make_shared<Commanding>(verb, session, words_help);
  verb.callback([commanding, &session] { carry_out(session, *commanding, commanding->parse()); });
}

}  // namespace ocm::cli
