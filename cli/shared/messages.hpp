/// How a verb says that something went wrong, or just something, to the person at the terminal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "ocm/client/counted.hpp"
#include "ocm/transport/bus.hpp"

namespace ocm::cli {

/// Documented in docs/amiroctl.md. 128 + signal when a signal ended the command.
enum ExitCode : int { exit_success = 0, exit_failure = 1, exit_usage = 2 };

/// Thrown after the message was printed; main returns the code.
struct Exit {
  int code;
};

/// From now on messages of wrong usage begin with this verb's name, such as "analyse bus". One program runs
/// one verb.
void speak_for(std::string_view verb);
/// The text with its control characters written as \x1b, line ends and tabs apart: file names, words of
/// scripts and names in logs must not command the terminal. All messages go through it.
[[nodiscard]] std::string printable(std::string_view text);
/// A message as it is printed where so many columns are: each of its lines broken between words.
[[nodiscard]] std::string folded_message(std::string_view text, std::size_t columns);
/// Prints "amiroctl: what" and the remedy on stderr and leaves with `code`.
[[noreturn]] void fail(const transport::Failure& failure, int code = exit_failure);
/// As fail, and goes on.
void complain(const transport::Failure& failure);
/// A remark for the person at the terminal, on stderr.
void remark(std::string_view text);
/// As long as it lives, messages are kept, because a screen is where they would be written; then they are
/// written. One at a time.
class HeldMessages {
 public:
  HeldMessages();
  ~HeldMessages();
  HeldMessages(const HeldMessages&) = delete;
  HeldMessages& operator=(const HeldMessages&) = delete;
  /// How many there are, and the newest; empty: none.
  [[nodiscard]] static std::size_t count();
  [[nodiscard]] static std::string_view newest();
};
using client::counted;
/// Adds ", COUNT what" to a summary, where there is something to count.
void add_count(std::string& text, std::uint64_t count, std::string_view what);
/// The same with a noun that has a plural: ", 1 error frame left out".
void add_count(std::string& text, std::uint64_t count, std::string_view noun, std::string_view what);

}  // namespace ocm::cli
