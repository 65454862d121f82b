/// An output on stdout: gathers lines and writes them in large pieces, or at once when nothing more is
/// waiting.
#pragma once

#include <cstddef>
#include <memory>
#include <string_view>
#include <utility>

#include "cli/output/output.hpp"

namespace ocm::cli {

/// Writes all of it to stdout. Leaves with exit_failure when stdout takes no more (a full disk, a closed
/// file), and after a signal when the reader has stopped.
void write_out(std::string_view text);
/// The same, and empties the buffer.
void write_out(Buffer& buffer);

class Printer {
 public:
  explicit Printer(std::unique_ptr<Output> output) : output_(std::move(output)) { output_->begin(buffer_); }
  /// Whether the event was shown.
  bool write(const Event& event) {
    const bool shown = output_->write(buffer_, event);
    if (buffer_.size() >= enough) flush();
    return shown;
  }
  void flush();
  /// Writes what stdout takes without a wait, and keeps the rest. Whether that was all. Leaves as write_out
  /// does.
  [[nodiscard]] bool flush_now();

 private:
  static constexpr std::size_t enough = 1 << 16;
  std::unique_ptr<Output> output_;
  Buffer buffer_;
  std::size_t written_ = 0;  ///< of the buffer
};

}  // namespace ocm::cli
