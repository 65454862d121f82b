/// The log of a central's line (cli/fleet/line_log.hpp) as a file.
#pragma once

#include <string>
#include <string_view>

#include "ocm/base/time.hpp"
#include "ocm/host/descriptor.hpp"

#include "cli/fleet/line_log.hpp"
#include "cli/shared/clock.hpp"

namespace ocm::cli::fleet {

/// Writes one.
class LineLog {
 public:
  /// Leaves through cli::fail where the file is there already, or cannot be made. `verb` is for messages.
  LineLog(std::string_view verb, std::string path);
  /// Of now. What a full disk does not take ends the log with a message; the line goes on.
  void write(std::string_view text);
  /// No write has failed.
  [[nodiscard]] bool is_whole() const noexcept { return static_cast<bool>(file_); }

 private:
  void put(std::string_view line);

  std::string verb_;
  std::string path_;
  host::Descriptor file_;
  // A clock that is set does not matter.
  base::Time begin_ = unix_time();
  Clock::time_point steady_begin_ = Clock::now();
};

/// Whether the file begins as such a log does.
[[nodiscard]] bool is_line_log(const std::string& path);
/// Leaves through cli::fail where it cannot be read, or is none.
[[nodiscard]] ReadLineLog read_line_log(std::string_view verb, const std::string& path);

}  // namespace ocm::cli::fleet
