#include "cli/analyse/set.hpp"

namespace ocm::cli::analyse {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

}  // namespace

std::vector<Line> split_csv(std::string_view text) {
  std::vector<Line> lines;
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // the byte order mark of a spreadsheet
  std::size_t number = 0;
  while (!text.empty()) {
    ++number;
    const auto end = text.find('\n');
    const std::string_view raw = trimmed(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (raw.empty() || raw.front() == '#') continue;
    Line line{number, {}};
    std::string cell;
    bool quoted = false;
    bool was_quoted = false;
    const auto finish = [&] {
      line.cells.push_back(was_quoted ? cell : std::string{trimmed(cell)});
      cell.clear();
      was_quoted = false;
    };
    for (std::size_t i = 0; i < raw.size(); ++i) {
      const char c = raw[i];
      if (quoted) {
        if (c != '"')
          cell += c;
        else if (i + 1 < raw.size() && raw[i + 1] == '"')
          cell += raw[++i];
        else
          quoted = false;
      } else if (c == '"' && trimmed(cell).empty() && !was_quoted) {
        cell.clear();
        quoted = was_quoted = true;
      } else if (c == ',') {
        finish();
      } else if (!was_quoted || (c != ' ' && c != '\t')) {
        cell += c;
      }
    }
    finish();
    lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace ocm::cli::analyse
