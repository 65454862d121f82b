/// The bytes of a file or of a pipe, read in the pieces that are asked for; the kernel expects that all of it
/// will be read, so that it reads ahead.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "ocm/log/input.hpp"

namespace ocm::cli::logs {

/// Whether a signal that was caught, which ends the command, ends the reading, too.
enum class Reading : bool { until_a_signal, to_the_end };

class FileSource final : public log::Source {
 public:
  /// "-": stdin. What went wrong is in `failure`.
  explicit FileSource(const std::string& path, Reading reading = Reading::until_a_signal);
  ~FileSource() override;

  /// The first bytes, up to four, which `read` hands out all the same. Waits for a pipe.
  [[nodiscard]] std::string_view beginning();
  /// Ends early, with a failure, when a signal was caught, unless it is to read to the end.
  std::size_t read(std::span<char> into) override;
  [[nodiscard]] const std::string& failure() const override { return failure_; }

  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }          ///< 0 for a pipe
  [[nodiscard]] std::uint64_t position() const noexcept { return position_; }  ///< bytes that were read

 private:
  std::size_t read_some(std::span<char> into);

  [[nodiscard]] bool cut_off() const;

  int descriptor_ = -1;
  Reading reading_;
  std::uint64_t size_ = 0;
  std::uint64_t position_ = 0;
  char head_[4] = {};
  std::size_t head_begin_ = 0;
  std::size_t head_end_ = 0;
  std::string failure_;
};

/// All of a file, as far as it could be read; nothing of one that is longer than `most`.
struct WholeFile {
  std::string text;
  std::string failure;    ///< of reading, or "interrupted"; empty: none
  bool too_long = false;  ///< no more of it was read
};
[[nodiscard]] WholeFile read_file(const std::string& path, std::size_t most);

/// Passes over the byte order mark that some editors put before a text.
inline void skip_byte_order_mark(log::Input& input) {
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  if (input.peek(1) == mark.substr(0, 1) && input.peek(mark.size()) == mark) input.skip(mark.size());
}

}  // namespace ocm::cli::logs
