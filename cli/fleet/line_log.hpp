/// What a central has said, with times, as a file: so a drive of mappers can be played again. Behind a first
/// line that says what it is, a line a piece, `(SECONDS) TEXT`: the time since 1970, six decimals, and what
/// came, in which bytes that are not printed, and the backslash, are `\x0a`. A piece may end anywhere.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/host/descriptor.hpp"

#include "cli/shared/clock.hpp"

namespace ocm::cli::fleet {

inline constexpr std::string_view line_log_begins = "# line of a central, version 1";

struct Said {
  base::Time time;
  std::string text;
};

/// The line for it, with its line feed.
[[nodiscard]] std::string to_log_line(base::Time time, std::string_view text);
/// Reads a line, given without its line feed. Empty where it does not have the form above, or its time is
/// after the year 2200.
[[nodiscard]] std::optional<Said> parse_log_line(std::string_view line);

/// Writes one.
class LineLog {
 public:
  /// Leaves through cli::fail where the file is there already, or cannot be made. `verb` is for messages.
  LineLog(std::string_view verb, std::string path);
  /// Of now. What a full disk does not take ends the log with a message; the line goes on.
  void write(std::string_view text);

 private:
  void put(std::string_view line);

  std::string verb_;
  std::string path_;
  host::Descriptor file_;
  // A clock that is set does not matter.
  base::Time begin_ = unix_time();
  Clock::time_point steady_begin_ = Clock::now();
};

/// A log that was read.
struct ReadLineLog {
  std::vector<Said> said;           ///< in the order of time
  std::uint64_t damaged = 0;        ///< lines that could not be read
  std::uint64_t first_damaged = 0;  ///< from 1
};
/// Whether the file begins as such a log does.
[[nodiscard]] bool is_line_log(const std::string& path);
/// Leaves through cli::fail where it cannot be read, or is none.
[[nodiscard]] ReadLineLog read_line_log(std::string_view verb, const std::string& path);

}  // namespace ocm::cli::fleet
