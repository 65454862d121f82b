/// Lines of generated code: indented, broken between words where they become too long.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace ocm::generate {

/// Generated lines are at most this long, where they can be broken.
inline constexpr std::size_t columns = 110;

class Writer {
 public:
  void line(std::string_view text = {});
  /// Whole lines, as they are.
  void text(std::string_view lines) { text_ += lines; }
  /// A line, and what follows is indented.
  void open(std::string_view text);
  void close(std::string_view text);
  /// As close, without a line.
  void undent() noexcept { --depth_; }
  /// Broken into lines between words.
  void comment(std::string_view text, std::string_view mark = "/// ");
  /// Lines with a remark each: behind them, aligned, where that fits; above them otherwise.
  void remarked(const std::vector<std::pair<std::string, std::string>>& lines);
  /// `head` + items, parted by commas and broken to fit, aligned behind the head + `tail`.
  void list(std::string_view head, const std::vector<std::string>& items, std::string_view tail);
  /// `target` = `head` + items + `tail`: in one line, else behind the sign in the next one, else as a list.
  void assignment(const std::string& target, const std::string& head, const std::vector<std::string>& items,
                  std::string_view tail);
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
  std::size_t depth_ = 0;
};

}  // namespace ocm::generate
