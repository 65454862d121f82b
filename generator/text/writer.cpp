#include "generator/text/writer.hpp"

#include <algorithm>

#include "ocm/base/utf8.hpp"

#include "generator/text/words.hpp"

namespace ocm::generate {

void Writer::line(std::string_view text) {
  if (!text.empty()) text_.append(2 * depth_, ' ').append(text);
  text_ += '\n';
}

void Writer::open(std::string_view text) {
  line(text);
  ++depth_;
}

void Writer::close(std::string_view text) {
  --depth_;
  line(text);
}

void Writer::comment(std::string_view text, std::string_view mark) {
  const std::string indent(2 * depth_, ' ');
  std::string current;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    const std::string_view word = text.substr(0, end);
    if (!current.empty() &&
        indent.size() + mark.size() + base::columns(current) + 1 + base::columns(word) > columns) {
      text_.append(indent).append(mark).append(current) += '\n';
      current.clear();
    }
    if (!current.empty()) current += ' ';
    current += word;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  if (!current.empty()) text_.append(indent).append(mark).append(current) += '\n';
}

void Writer::remarked(const std::vector<std::pair<std::string, std::string>>& lines) {
  std::size_t widest = 0;
  std::size_t longest = 0;
  for (const auto& [code, remark] : lines)
    if (!remark.empty()) widest = std::max(widest, base::columns(code));
  for (const auto& [code, remark] : lines)
    if (!remark.empty()) longest = std::max(longest, 2 * depth_ + widest + 7 + base::columns(remark));
  for (const auto& [code, remark] : lines) {
    if (remark.empty()) {
      line(code);
    } else if (longest <= columns) {
      line(code + std::string(widest - base::columns(code) + 2, ' ') + "///< " + remark);
    } else {
      comment(remark);
      line(code);
    }
  }
}

void Writer::list(std::string_view head, const std::vector<std::string>& items, std::string_view tail) {
  const std::string indent(2 * depth_, ' ');
  const std::string hang(indent.size() + head.size(), ' ');
  std::string current = indent + std::string{head};
  bool first = true;
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::string piece = items[i] + (i + 1 < items.size() ? "," : std::string{tail});
    if (!first && base::columns(current) + 1 + base::columns(piece) > columns) {
      text_.append(current) += '\n';
      current = hang;
      first = true;
    }
    if (!first) current += ' ';
    current += piece;
    first = false;
  }
  if (items.empty()) current += tail;
  text_.append(current) += '\n';
}

void Writer::assignment(const std::string& target, const std::string& head,
                        const std::vector<std::string>& items, std::string_view tail) {
  std::size_t length = base::columns(head) + tail.size();
  for (const std::string& item : items) length += base::columns(item) + 2;
  if (!items.empty()) length -= 2;
  const bool whole = 2 * depth_ + base::columns(target) + 3 + length <= columns;
  if (whole || 2 * depth_ + 4 + length > columns) return list(target + " = " + head, items, tail);
  line(target + " =");
  depth_ += 2;
  list(head, items, tail);
  depth_ -= 2;
}

}  // namespace ocm::generate
