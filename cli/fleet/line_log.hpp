/// What a central has said, with times, as text: so a drive of mappers can be played again. Behind a first
/// line that says what it is, a line a piece, `(SECONDS) TEXT`: the time since 1970, six decimals, and what
/// came, in which bytes that are not printed, and the backslash, are `\x0a`. A piece may end anywhere.
/// cli/fleet/line_log_file.hpp has it as a file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/time.hpp"

namespace ocm::cli::fleet {

inline constexpr std::string_view line_log_begins = "# line of a central, version 1";

struct Said {
  base::Time time;
  std::string text;
};

/// The line for it, with its line feed. A time is one of the years 1970 to 2200, and is cut to microseconds.
[[nodiscard]] std::string to_log_line(base::Time time, std::string_view text);
/// Reads a line, given without its line feed. Empty where it does not have the form above, or its time is
/// after the year 2200.
[[nodiscard]] std::optional<Said> parse_log_line(std::string_view line);

/// A log that was read.
struct ReadLineLog {
  std::vector<Said> said;           ///< in the order of time
  std::uint64_t damaged = 0;        ///< lines that could not be read, go back in time, or have no line feed
  std::uint64_t first_damaged = 0;  ///< from 1; 0: none
};
/// Reads all of one. Empty where its first line is another.
[[nodiscard]] std::optional<ReadLineLog> parse_line_log(std::string_view text);

}  // namespace ocm::cli::fleet
