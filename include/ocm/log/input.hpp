/// Bytes of a log, read in large blocks and looked at in place: memory stays the same whatever the size of
/// the log. A reader asks for lines, or for so many bytes at once; both are views that hold until the next
/// call.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace ocm::log {

/// Where bytes come from: a file, a pipe, a decompressor, memory.
class Source {
 public:
  Source() = default;
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;
  virtual ~Source() = default;
  /// At least one byte and at most `into.size()`; 0 at the end, and where it cannot go on: then `failure`
  /// says why. May wait for a pipe.
  virtual std::size_t read(std::span<char> into) = 0;
  [[nodiscard]] virtual const std::string& failure() const = 0;  ///< empty: none
};

/// Bytes that are all there already.
class MemorySource final : public Source {
 public:
  explicit MemorySource(std::string_view bytes) : bytes_(bytes) {}
  std::size_t read(std::span<char> into) override {
    const std::size_t count = std::min(into.size(), bytes_.size());
    bytes_.copy(into.data(), count);
    bytes_.remove_prefix(count);
    return count;
  }
  [[nodiscard]] const std::string& failure() const override { return failure_; }

 private:
  std::string_view bytes_;
  std::string failure_;
};

class Input {
 public:
  static constexpr std::size_t block = std::size_t{1} << 18;
  /// A longer line or record is refused before it takes memory: no frame needs a kilobyte, no pcapng block or
  /// MCAP chunk that tools write more than some megabytes.
  static constexpr std::size_t longest = std::size_t{16} << 20;
  /// So many bytes behind a view can be read (they are zero or of what follows).
  static constexpr std::size_t padding = 64;

  /// The source must outlive the input. `room` is what is read at once at first; it grows with the longest
  /// line or record.
  explicit Input(Source& source, std::size_t room = block)
      : source_(&source), bytes_(allocate(room)), capacity_(room) {}

  /// The next `count` bytes, not taken yet; fewer only at the end of the log, and when `count` > `longest`.
  [[nodiscard]] std::string_view peek(std::size_t count) {
    while (end_ - begin_ < count && count <= longest && fill()) {
    }
    return {bytes_.get() + begin_, std::min(count, end_ - begin_)};
  }
  /// Bytes that `peek` shows without waiting for more.
  [[nodiscard]] std::size_t here() const noexcept { return end_ - begin_; }
  /// Of what `peek` has shown.
  void skip(std::size_t count) noexcept {
    begin_ += count;
    offset_ += count;
  }
  /// As `skip`, of a whole line with its end: a reader found both on its own way.
  void skip_line(std::size_t count) noexcept {
    skip(count);
    ++line_;
  }
  /// Takes `count` bytes without looking at them, however many. false: the log has less.
  [[nodiscard]] bool discard(std::uint64_t count) {
    while (count > 0) {
      if (begin_ == end_ && !fill()) return false;
      const std::size_t step = static_cast<std::size_t>(std::min<std::uint64_t>(count, end_ - begin_));
      skip(step);
      count -= step;
    }
    return true;
  }

  /// What take_line found.
  enum class Line : std::uint8_t {
    whole,     ///< `line` holds it, without its end (LF or CR LF)
    last,      ///< as whole, but the log ends without the end of the line
    too_long,  ///< over `longest`: passed over, `line` holds its beginning
    later,     ///< not whole yet, and the caller does not wait
    none,      ///< the log is at its end
  };
  /// Whether to wait for bytes that are not here yet: a reader that has something to hand on already does
  /// not, so that a pipe from a live bus shows each frame when it comes.
  enum class Wait : bool { no, yes };
  [[nodiscard]] Line take_line(std::string_view& line, Wait wait = Wait::yes) {
    std::size_t seen = 0;
    for (;;) {
      const char* const from = bytes_.get() + begin_;
      const std::size_t have = end_ - begin_;
      if (const void* const found = have > seen ? std::memchr(from + seen, '\n', have - seen) : nullptr) {
        const auto size = static_cast<std::size_t>(static_cast<const char*>(found) - from);
        skip(size + 1);
        ++line_;
        line = {from, size > 0 && from[size - 1] == '\r' ? size - 1 : size};
        return Line::whole;
      }
      seen = have;
      if (have >= longest) return pass_over(line);
      if (wait == Wait::no && !at_end_) return Line::later;
      if (fill()) continue;
      if (have == 0) return Line::none;
      line = {bytes_.get() + begin_, have};
      skip(have);
      ++line_;
      return Line::last;
    }
  }

  /// Of the next byte, from the beginning of the log.
  [[nodiscard]] std::uint64_t offset() const noexcept { return offset_; }
  /// Number of the last line that was taken, from 1.
  [[nodiscard]] std::uint64_t line_number() const noexcept { return line_; }
  /// Why the source ended early; empty: it did not.
  [[nodiscard]] const std::string& failure() const noexcept { return source_->failure(); }

 private:
  static std::unique_ptr<char[]> allocate(std::size_t size) {
    return std::unique_ptr<char[]>{new char[size + padding]{}};
  }

  /// Reads once, behind what is here. The memory grows with what has come, not with what a header promises.
  /// false: the end.
  bool fill() {
    if (at_end_) return false;
    const std::size_t have = end_ - begin_;
    if (have == 0 || end_ == capacity_) {
      if (have == capacity_) {
        auto grown = allocate(2 * capacity_);
        std::memcpy(grown.get(), bytes_.get(), have);
        bytes_ = std::move(grown);
        capacity_ *= 2;
      } else if (have != 0) {
        std::memmove(bytes_.get(), bytes_.get() + begin_, have);
      }
      begin_ = 0;
      end_ = have;
    }
    const std::size_t count = source_->read({bytes_.get() + end_, capacity_ - end_});
    end_ += count;
    std::memset(bytes_.get() + end_, 0, padding);
    at_end_ = count == 0;
    return !at_end_;
  }

  Line pass_over(std::string_view& line) {
    // Its beginning stays where it is shown; the rest goes by behind it.
    beginning_.assign(bytes_.get() + begin_, 64);
    for (;;) {
      const std::string_view rest = peek(block);
      const std::size_t end = rest.find('\n');
      skip(end == std::string_view::npos ? rest.size() : end + 1);
      if (end != std::string_view::npos || rest.empty()) break;
    }
    ++line_;
    line = beginning_;
    return Line::too_long;
  }

  Source* source_;
  std::unique_ptr<char[]> bytes_;
  std::size_t capacity_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::uint64_t offset_ = 0;
  std::uint64_t line_ = 0;
  bool at_end_ = false;
  std::string beginning_;
};

}  // namespace ocm::log
