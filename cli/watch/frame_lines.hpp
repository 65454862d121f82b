/// Frames from lines of text, for the verbs that take them one by one: JSON lines, lines of a candump log,
/// frames in candump's notation, one way or another in each line. A line that cannot be read is reported with
/// file, line and remedy; then it is over, or the next one is looked at.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "ocm/log/entry.hpp"
#include "ocm/log/input.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/logs/file_source.hpp"
#include "cli/logs/json_lines.hpp"

namespace ocm::cli {

class FrameLines {
 public:
  /// `path`: "-" is the standard input. Leaves through cli::fail when it cannot be read.
  FrameLines(std::string path, const protocol::Catalogue& catalogue, bool keep_going,
             logs::Values values = logs::Values::of_bits);

  /// The next frame; waits for it. `bus` is empty where the line does not say, and holds until the next call.
  /// false: the end, a signal, or a bad line.
  [[nodiscard]] bool next(log::Entry& entry, std::string_view& bus);
  /// Whether that frame has a time: its line's, or of a line before it.
  [[nodiscard]] bool has_time() const noexcept { return json_.last_time().has_value(); }
  /// Whether anything is there without waiting.
  [[nodiscard]] bool more_here() const noexcept { return input_.here() != 0; }
  /// Whether some line could not be read, or the input ended early.
  [[nodiscard]] bool failed() const noexcept { return bad_ != 0 || broken_; }
  [[nodiscard]] std::uint64_t bad_lines() const noexcept { return bad_; }
  /// Reports, at the end, what of JSON lines was passed over.
  void tell_unknown_keys() const;

 private:
  [[nodiscard]] bool parse(std::string_view line, log::Entry& entry, std::string_view& bus);
  [[nodiscard]] bool parse_log_line(std::string_view line, log::Entry& entry, std::string_view& bus);
  void tell() const;

  std::string path_;
  logs::FileSource source_;
  log::Input input_;
  logs::JsonLineParser json_;
  logs::JsonProblem problem_;
  bool keep_going_;
  bool broken_ = false;
  std::uint64_t bad_ = 0;
};

}  // namespace ocm::cli
