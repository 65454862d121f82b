#include "cli/command/commanding.hpp"

#include <memory>

#include <fmt/format.h>

#include "ocm/can/text.hpp"

#include "cli/shared/outgoing.hpp"
#include "cli/shared/values.hpp"

namespace ocm::cli {

Commanding::Commanding(Verb verb, Session& session, std::string_view words_help, bool with_priority)
    : verb_(verb.name()), session_(&session) {
  verb.add_option("words", words_, std::string{words_help})
      .type_name("")
      .in_usage(std::string{words::form_of(verb_)});
  if (with_priority)
    add_priority(verb, "--priority", options_.priority,
                 "urgent, high, medium or low, or 0 to 3; default: the topic's own");
  verb.add_flag("--dry-run", dry_run_, "print the frames in candump notation and send nothing");
}

client::Command Commanding::parse() const {
  std::vector<std::string_view> words{verb_};
  words.insert(words.end(), words_.begin(), words_.end());
  auto command = words::CommandParser{session_->catalogue(), "amiroctl "}.parse(words, options_);
  if (!command) fail({verb_ + ": " + command.error.what, command.error.remedy}, exit_usage);
  return std::move(command.value);
}

void print_frames(const std::vector<can::Frame>& frames) {
  for (const auto& frame : frames) fmt::print("{}\n", can::to_text(frame).view());
}

void carry_out(Session& session, std::string_view verb, const client::Command& command, bool dry_run) {
  if (dry_run) return print_frames(command.frames);
  const auto bus = session.open_bus();
  Outgoing outgoing{*bus, std::string{verb}, command.ends_hold ? still_moving : ""};
  for (const auto& frame : command.frames) outgoing.send(frame);
  outgoing.expect_all_left();
}

void add_command_verb(Verb app, Session& session, std::string_view name, std::string_view description,
                      std::string_view group, std::string_view words_help, std::string_view examples,
                      bool with_priority) {
  auto verb = app.add_verb(name, description, group, examples);
  const auto commanding = std::make_shared<Commanding>(verb, session, words_help, with_priority);
  verb.callback([commanding, &session] {
    carry_out(session, commanding->verb(), commanding->parse(), commanding->dry_run());
  });
}

}  // namespace ocm::cli
