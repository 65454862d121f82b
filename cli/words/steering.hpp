/// Driving by keys that are held. A terminal does not say when a key is released: it sends the key when it is
/// pressed and, after a while, again and again. So a direction ends when its key has not come again in time.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"

#include "cli/words/quantity.hpp"
#include "cli/words/word_error.hpp"

namespace ocm::cli::words {

/// Where the keys say to go: forward or back, to the left or right.
struct Direction {
  int forward = 0;  ///< 1, 0 or -1
  int left = 0;
  friend bool operator==(const Direction&, const Direction&) = default;
};

/// A velocity that keys make larger and smaller: "10cm/s", in steps of a quarter.
class KeySpeed {
 public:
  static constexpr int most_steps = 12;

  /// The failure says what would be right.
  [[nodiscard]] static base::Result<KeySpeed, WordError> parse(std::string_view text) {
    const auto quantity = parse_quantity(text);
    if (!quantity || quantity->unit.empty() || !(quantity->number.as_double() > 0))
      return WordError{0, fmt::format("'{}' is no speed", text),
                       "write one above zero with its unit: 10cm/s, 45deg/s"};
    KeySpeed speed;
    speed.number_ = quantity->number.as_double();
    speed.unit_ = quantity->unit;
    return speed;
  }
  void change(int steps) noexcept { steps_ = std::clamp(steps_ + steps, -most_steps, most_steps); }
  [[nodiscard]] int steps() const noexcept { return steps_; }
  /// A part of it, -1 to 1, as it is typed.
  [[nodiscard]] std::string text(double part = 1) const {
    const bool typed = steps_ == 0 && std::abs(part) == 1;
    return typed ? fmt::format("{}{}", value(part), unit_) : fmt::format("{:.6g}{}", value(part), unit_);
  }
  /// In three digits, or as many as are before the point.
  [[nodiscard]] std::string shown(double part = 1) const {
    const double speed = value(part);
    return std::abs(speed) < 999.5 ? fmt::format("{:.3g}{}", speed, unit_)
                                   : fmt::format("{:.0f}{}", speed, unit_);
  }

 private:
  [[nodiscard]] double value(double part) const { return part * number_ * std::pow(1.25, steps_); }

  double number_ = 0;
  std::string unit_;
  int steps_ = 0;
};

class Steering {
 public:
  /// Until a key that was just pressed must come again: terminals wait up to 660 ms before they repeat one.
  static constexpr base::Duration first_repeat = std::chrono::milliseconds{700};
  /// Until one that is repeated must come again: terminals repeat it ten times a second or more.
  static constexpr base::Duration next_repeat = std::chrono::milliseconds{250};

  /// What keys ask for beside a direction.
  enum class Ask : std::uint8_t { nothing, stop, faster, slower, quit };

  /// The next key of what a terminal sent, which is taken off `bytes`.
  Ask take(std::string_view& bytes, base::Duration now) {
    const std::string_view key = next_key(bytes);
    bytes.remove_prefix(key.size());
    struct Meaning {
      std::string_view key;
      Direction direction;
    };
    // The arrows, in both of a terminal's modes; letters as ROS's teleop_twist_keyboard has them.
    static constexpr Meaning meanings[] = {
        {"\x1b[A", {1, 0}},  {"\x1bOA", {1, 0}},  {"i", {1, 0}},       {"\x1b[B", {-1, 0}},
        {"\x1bOB", {-1, 0}}, {",", {-1, 0}},      {"\x1b[D", {0, 1}},  {"\x1bOD", {0, 1}},
        {"j", {0, 1}},       {"\x1b[C", {0, -1}}, {"\x1bOC", {0, -1}}, {"l", {0, -1}},
        {"u", {1, 1}},       {"o", {1, -1}},      {"m", {-1, 1}},      {".", {-1, -1}}};
    for (const Meaning& meaning : meanings) {
      if (meaning.key != key) continue;
      const bool repeated = direction(now) == meaning.direction;
      // Held: it came again before the first wait was over, sooner than a person presses twice.
      const bool held = repeated && (held_ || now - pressed_ > std::chrono::milliseconds{150});
      if (!repeated) pressed_ = now;
      held_ = held;
      direction_ = meaning.direction;
      until_ = now + (held ? next_repeat : first_repeat);
      return Ask::nothing;
    }
    if (key == " " || key == "k") {
      release();
      return Ask::stop;
    }
    if (key == "+" || key == "=") return Ask::faster;
    if (key == "-") return Ask::slower;
    if (key == "q" || key == "\x1b" || key == "\x04") return Ask::quit;
    return Ask::nothing;
  }
  void release() noexcept { direction_ = {}; }

  [[nodiscard]] Direction direction(base::Duration now) const noexcept {
    return now < until_ ? direction_ : Direction{};
  }

 private:
  /// A sequence that begins with ESC, as far as it came, or one character.
  [[nodiscard]] static std::string_view next_key(std::string_view bytes) noexcept {
    if (bytes.size() < 2 || bytes[0] != '\x1b' || (bytes[1] != '[' && bytes[1] != 'O'))
      return bytes.substr(0, 1);
    for (std::size_t end = 2; end < bytes.size(); ++end) {
      if (bytes[end] == '\x1b') return bytes.substr(0, end);  // another begins: this one has no end
      if (bytes[end] >= '@' && bytes[end] <= '~') return bytes.substr(0, end + 1);
    }
    return bytes;
  }

  Direction direction_;
  base::Duration until_ = base::Duration::min();
  base::Duration pressed_ = base::Duration::min() / 2;
  bool held_ = false;
};

}  // namespace ocm::cli::words
