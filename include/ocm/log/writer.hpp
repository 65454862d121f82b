/// A log format that is written. A writer appends bytes; the file's owner writes them out, so that the
/// same writer serves a file, a pipe and a test. What the format cannot hold is counted by kind.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "ocm/log/bytes.hpp"
#include "ocm/log/entry.hpp"
#include "ocm/log/interfaces.hpp"
#include "ocm/log/reader.hpp"

namespace ocm::log {

/// What an entry had and the format has not.
enum class Lost : std::uint8_t {
  entry,        ///< the whole entry: the format has no such frames. All others: it was written without that
  time,         ///< all of its time, which the format cannot say, too early or too late: it says the nearest
  time_digits,  ///< digits of its time, beyond the format's finest
  direction,
  interface,  ///< its name; the format has numbers, or none. An empty name is none
  fd_flags,
  raw_dlc,
  remote_length,
  error_detail,  ///< what kind of error an error frame reports
};
inline constexpr std::size_t losses = 9;

/// Goes before the number of frames of which it is lost: "the direction of" 2 frames.
[[nodiscard]] constexpr std::string_view describe(Lost lost) noexcept {
  constexpr std::string_view words[losses] = {"all of",
                                              "the time of",
                                              "digits of the time of",
                                              "the direction of",
                                              "the name of the interface of",
                                              "flags of CAN FD of",
                                              "the length code over 8 of",
                                              "the length of remote",
                                              "the kind of error of"};
  return words[static_cast<std::size_t>(lost)];
}

class Losses {
 public:
  void add(Lost lost, std::uint64_t count = 1) noexcept { counts_[static_cast<std::size_t>(lost)] += count; }
  [[nodiscard]] std::uint64_t count(Lost lost) const noexcept {
    return counts_[static_cast<std::size_t>(lost)];
  }
  [[nodiscard]] bool any() const noexcept {
    for (const auto count : counts_)
      if (count != 0) return true;
    return false;
  }

 private:
  std::array<std::uint64_t, losses> counts_{};
};

class Writer {
 public:
  Writer() = default;
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  virtual ~Writer() = default;

  /// What stands at the beginning of the file, if anything. Once, before all else.
  virtual void begin(Bytes&) {}
  /// Appends the entries. `interfaces` is the same object in every call, and may have grown.
  virtual void write(Bytes& out, std::span<const Entry> entries, const Interfaces& interfaces) = 0;
  /// What the format gathers before it is written, if anything, comes out now.
  virtual void flush(Bytes&) {}
  /// What the recorder knows at the end of each interface, by number. Where the format has no room for it,
  /// nothing.
  virtual void recorded(Bytes&, std::span<const Recorded>) {}
  /// What stands at the end. Without it (killed) the file can still be read, up to a last
  /// line or record that may be cut off.
  virtual void finish(Bytes&) {}

  [[nodiscard]] const Losses& lost() const noexcept { return losses_; }

 protected:
  Losses losses_;
};

}  // namespace ocm::log
