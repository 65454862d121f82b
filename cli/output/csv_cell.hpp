/// Text as a cell of a CSV table.
#pragma once

#include <string>
#include <string_view>

namespace ocm::cli {

/// In quotes where it has to be: a comma, a quote, a line feed, or a # that would begin a comment.
[[nodiscard]] inline std::string csv_cell(std::string_view text) {
  if (text.find_first_of(",\"\n#") == std::string_view::npos) return std::string{text};
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

}  // namespace ocm::cli
