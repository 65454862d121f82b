/// What the verbs that send commands have in common: words and options, read already, go to the same parser
/// that reads scripts, and the frames to the bus or, with --dry-run, to stdout.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "cli/command/refusal_watch.hpp"
#include "cli/shared/arguments.hpp"
#include "cli/shared/session.hpp"
#include "cli/words/command.hpp"

namespace ocm::cli {

class Commanding {
 public:
  Commanding(const Commanding&) = delete;  // the options write into its members
  Commanding& operator=(const Commanding&) = delete;
  /// What a verb sends. A frame as it is has no other priority, and is not confirmed; a request is by the
  /// first sample, too.
  enum class Sends : std::uint8_t { raw_frames, commands, requests };
  /// Adds the positional words and --dry-run to `verb`; of commands --priority and --no-confirm.
  Commanding(Verb verb, Session& session, std::string_view words_help, Sends sends = Sends::commands);

  /// That of its words: of the bus that it speaks to.
  [[nodiscard]] const protocol::Catalogue& catalogue() const { return session_->catalogue_on_bus(!dry_run_); }
  /// The command, or exit_usage with a message that names the word.
  [[nodiscard]] client::Command parse() const;
  /// What the options of the command line say; a verb adds its own to them.
  [[nodiscard]] words::CommandOptions& options() { return options_; }
  /// Those of the command line.
  [[nodiscard]] const std::vector<std::string>& words() const { return words_; }
  [[nodiscard]] bool dry_run() const { return dry_run_; }
  [[nodiscard]] Confirm confirm() const { return raw_ || no_confirm_ ? Confirm::no : Confirm::yes; }
  [[nodiscard]] const std::string& verb() const { return verb_; }

 private:
  std::string verb_;
  Session* session_;
  std::vector<std::string> words_;
  words::CommandOptions options_;
  bool dry_run_ = false;
  bool raw_ = false;
  bool no_confirm_ = false;
};

/// --no-confirm.
void add_no_confirm(Verb verb, bool& no_confirm);

/// Sends the command's frames once, or prints them. Leaves with exit_failure, and says why, unless they left
/// this machine, no board refuses them, and the boards that got set points are there.
void carry_out(Session& session, const Commanding& commanding, const client::Command& command);

/// Prints a command's frames in candump notation, one a line.
void print_frames(const client::Command& command);

/// A plain command verb: parse, carry out. For stop, led, set.
void declare_command_verb(Verb verb, Session& session, std::string_view description, std::string_view group,
                          std::string_view words_help, std::string_view examples);

}  // namespace ocm::cli
