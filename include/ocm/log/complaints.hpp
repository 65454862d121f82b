/// What is wrong with a log, and where: counted by cause, the first few kept in words. A line that cannot be
/// read is passed over and told of; the rest of the log is read all the same.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ocm::log {

enum class Cause : std::uint8_t {
  syntax,       ///< not of the form that the format has here
  identifier,   ///< out of range for its frame format
  length,       ///< a length that no such frame has
  time,         ///< no time, or one beyond 1677..2262 (64 bits of nanoseconds)
  too_long,     ///< a line or block longer than a sane log has: see Input
  unsupported,  ///< well formed, but not a CAN frame, or of a kind that this reader does not know
  checksum,     ///< the format's own check fails
  compressed,   ///< compressed data that cannot be unpacked
  truncated,    ///< the log ends in the middle
  cut_line,     ///< the last line of a text has no end, and is no whole one
  input,        ///< the file itself cannot be read any further
};
inline constexpr std::size_t causes = 11;

[[nodiscard]] constexpr std::string_view describe(Cause cause) noexcept {
  constexpr std::string_view words[causes] = {"not of the expected form",
                                              "identifier out of range",
                                              "length that no frame has",
                                              "no valid time",
                                              "longer than any log has",
                                              "not a CAN frame",
                                              "wrong checksum",
                                              "cannot be unpacked",
                                              "ends in the middle",
                                              "last line cut off: its writer was ended",
                                              "cannot be read"};
  return words[static_cast<std::size_t>(cause)];
}

/// Line of a text, counted from 1; or byte of a file, counted from 0.
struct Place {
  std::uint64_t number = 0;
  bool is_line = false;
  friend bool operator==(const Place&, const Place&) = default;
};

/// "line 12", "byte 4096".
[[nodiscard]] inline std::string to_text(Place place) {
  return (place.is_line ? "line " : "byte ") + std::to_string(place.number);
}

struct Complaint {
  Cause cause = Cause::syntax;
  Place place;
  std::string detail;  ///< what was found there, for a person
};

class Complaints {
 public:
  static constexpr std::size_t kept = 8;

  void add(Cause cause, Place place, std::string_view detail) {
    ++counts_[static_cast<std::size_t>(cause)];
    if (first_.size() < kept) first_.push_back({cause, place, printable(detail)});
  }
  [[nodiscard]] std::uint64_t count(Cause cause) const noexcept {
    return counts_[static_cast<std::size_t>(cause)];
  }
  [[nodiscard]] std::uint64_t total() const noexcept {
    std::uint64_t sum = 0;
    for (const auto count : counts_) sum += count;
    return sum;
  }
  [[nodiscard]] const std::vector<Complaint>& first() const noexcept { return first_; }

  /// A log may hold anything; a terminal must not obey it. At most 60 characters.
  [[nodiscard]] static std::string printable(std::string_view text) {
    std::string out;
    for (const char c : text.substr(0, 60)) out += c >= ' ' && c <= '~' ? c : '?';
    return text.size() > 60 ? out + "..." : out;
  }

 private:
  std::array<std::uint64_t, causes> counts_{};
  std::vector<Complaint> first_;
};

}  // namespace ocm::log
