#include "cli/top/line.hpp"

namespace ocm::cli::top {

void LineWriter::put(std::string_view text, Style style) {
  std::size_t bytes = 0, columns = 0;
  while (bytes < text.size() && columns < room()) {
    bytes += std::max<std::size_t>(base::utf8_length(text.substr(bytes)), 1);
    ++columns;
  }
  used_ += columns;
  if (!line_.empty() && line_.back().style == style)
    line_.back().text += text.substr(0, bytes);
  else if (bytes > 0)
    line_.push_back({std::string{text.substr(0, bytes)}, style});
}

std::string left(std::string_view text, std::size_t width) {
  std::size_t bytes = 0, columns = 0;
  while (bytes < text.size() && columns < width) {
    bytes += std::max<std::size_t>(base::utf8_length(text.substr(bytes)), 1);
    ++columns;
  }
  return std::string{text.substr(0, bytes)} + std::string(width - columns, ' ');
}

std::string right(std::string_view text, std::size_t width) {
  const std::size_t columns = base::columns(text);
  return columns < width ? std::string(width - columns, ' ') + std::string{text} : std::string{text};
}

}  // namespace ocm::cli::top
