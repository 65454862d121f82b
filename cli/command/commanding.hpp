/// What the verbs that send commands have in common: words and options, read already, go to the same parser
/// that reads scripts, and the frames to the bus or, with --dry-run, to stdout.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "cli/shared/arguments.hpp"
#include "cli/shared/session.hpp"
#include "cli/words/command.hpp"

namespace ocm::cli {

class Commanding {
 public:
  Commanding(const Commanding&) = delete;  // the options write into its members
  Commanding& operator=(const Commanding&) = delete;
  /// Adds the positional words, --priority and --dry-run to `verb`.
  Commanding(Verb verb, Session& session, std::string_view words_help, bool with_priority = true);

  /// The command, or exit_usage with a message that names the word.
  [[nodiscard]] client::Command parse() const;
  /// What the options of the command line say; a verb adds its own to them.
  [[nodiscard]] words::CommandOptions& options() { return options_; }
  [[nodiscard]] bool dry_run() const { return dry_run_; }
  [[nodiscard]] const std::string& verb() const { return verb_; }

 private:
  std::string verb_;
  Session* session_;
  std::vector<std::string> words_;
  words::CommandOptions options_;
  bool dry_run_ = false;
};

/// Sends the command's frames once, or prints them. Leaves through cli::fail unless they left this machine.
void carry_out(Session& session, std::string_view verb, const client::Command& command, bool dry_run);

/// Prints frames in candump notation, one a line.
void print_frames(const std::vector<can::Frame>& frames);

/// A plain command verb: parse, carry out. For stop, led, set, send.
void add_command_verb(Verb app, Session& session, std::string_view name, std::string_view description,
                      std::string_view group, std::string_view words_help, std::string_view examples,
                      bool with_priority = true);

}  // namespace ocm::cli
