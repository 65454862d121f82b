/// What a central says, parted again: its own lines (answers to commands, reports of links) and the packets
/// of robots with their prefixes. The two interleave: an answer may follow a packet that ends within a
/// sentence, on the same line.
///
/// Robots say capitals, digits and signs, packed updates bytes from 0x80; all lines of the central begin with
/// a small letter, but for those of `list`, and these follow a line of its own. So a small letter behind a
/// packet begins a line of the central, which is held back until its line feed; if it is none that a central
/// has, it goes where it came from. What is cut short by a packet is dropped and counted.
///
/// O(1) a byte, at most `most_held` bytes are held. Host only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "ocm/base/text.hpp"
#include "ocm/mapper/link/prefix.hpp"

namespace ocm::mapper::server {

/// A line of the central. [mapper/link/central.hpp]
struct CentralLine {
  enum class Kind : std::uint8_t {
    unknown,
    scanning,
    found,   ///< `found 2`: scanning has ended
    listed,  ///< `0:C0000000000A:AVR`
    end_of_list,
    connecting,
    connected,  ///< a report, as are closed and lost
    data,       ///< data mode with robot `index`
    closing,
    closed,
    lost,
    command,  ///< command mode
    reset,
    error,  ///< `text` says why; `index` where it ends with one
  };
  Kind kind = Kind::unknown;
  unsigned index = 0;
  std::string_view text{};     ///< of an error: why; of a listed robot: its name
  std::string_view address{};  ///< of a listed robot
};

namespace detail {

/// The number with which a text begins, as in `3; conn first`. False when it begins with none.
constexpr bool leading_number(std::string_view text, unsigned& number) noexcept {
  std::size_t digits = 0;
  while (digits < text.size() && base::is_digit(text[digits])) ++digits;
  const auto parsed = base::parse_unsigned(text.substr(0, digits));
  if (!parsed || *parsed > 255) return false;
  number = static_cast<unsigned>(*parsed);
  return true;
}

}  // namespace detail

/// A line without its line feed.
[[nodiscard]] constexpr CentralLine parse_central_line(std::string_view line) noexcept {
  using Kind = CentralLine::Kind;
  struct Word {
    std::string_view text;
    Kind kind;
    bool number;
  };
  constexpr Word words[] = {{"scanning", Kind::scanning, false},
                            {"found ", Kind::found, true},
                            {"end of list", Kind::end_of_list, false},
                            {"connecting ", Kind::connecting, true},
                            {"connected ", Kind::connected, true},
                            {"data ", Kind::data, true},
                            {"closing ", Kind::closing, true},
                            {"closed ", Kind::closed, true},
                            {"lost ", Kind::lost, true},
                            {"command", Kind::command, false},
                            {"reset", Kind::reset, false}};
  CentralLine out;
  constexpr std::string_view error = "error: ";
  if (line.starts_with(error)) {
    out.kind = Kind::error;
    out.text = line.substr(error.size());
    constexpr std::string_view no_link = "no link to ";
    if (out.text.starts_with(no_link))
      (void)detail::leading_number(out.text.substr(no_link.size()), out.index);
    return out;
  }
  for (const Word& word : words) {
    if (!line.starts_with(word.text)) continue;
    const std::string_view rest = line.substr(word.text.size());
    const auto number = base::parse_unsigned(rest);
    if (word.number ? !number || *number > 256 : !rest.empty()) continue;
    out.kind = word.kind;
    if (word.number) out.index = static_cast<unsigned>(*number);
    return out;
  }
  // index:address:name
  const std::size_t first = line.find(':');
  const std::size_t second = first == std::string_view::npos ? first : line.find(':', first + 1);
  if (second == std::string_view::npos || second + 1 == line.size()) return out;
  const auto index = base::parse_unsigned(line.substr(0, first));
  const std::string_view address = line.substr(first + 1, second - first - 1);
  if (!index || *index > 255 || address.size() != 12) return out;
  for (const char c : address)
    if (base::hex_digit(c) < 0) return out;
  return {Kind::listed, static_cast<unsigned>(*index), line.substr(second + 1), address};
}
static_assert(parse_central_line("0:C0000000000A:AVR").text == "AVR");
static_assert(parse_central_line("error: no link to 2; conn first").index == 2);
static_assert(parse_central_line("found two").kind == CentralLine::Kind::unknown);

class CentralStream {
 public:
  static constexpr std::size_t most_held = 80;  ///< no line of a central is longer

  /// `robots(char)` gets the stream of packets and prefixes, `line(CentralLine)` what the central said.
  template <class Robots, class Line>
  void feed(char c, Robots&& robots, Line&& line) {
    if (c == '[') {
      if (!held_.empty()) ++cut_;
      held_.clear();
      own_ = false;
      in_prefix_ = filter_.feed(c) == link::PrefixFilter::Step::prefix;
      return robots(c);
    }
    if (in_prefix_) {
      in_prefix_ = filter_.feed(c) == link::PrefixFilter::Step::prefix;
      return robots(c);
    }
    if (!own_ && held_.empty() && !(c >= 'a' && c <= 'z')) return robots(c);
    if (c == '\n' || c == '\r') return end_line(c, robots, line);
    held_ += c;
    if (held_.size() > most_held) give_back(robots);
  }

  /// Lines that were cut short by a packet, or were none and stood between the central's own.
  [[nodiscard]] std::uint32_t cut() const noexcept { return cut_; }

 private:
  template <class Robots, class Line>
  void end_line(char c, Robots&& robots, Line&& line) {
    const std::string held = std::exchange(held_, {});
    const CentralLine said = parse_central_line(held);
    if (said.kind != CentralLine::Kind::unknown) {
      own_ = true;
      return line(said);
    }
    if (held.empty()) return;
    if (own_) return void(++cut_);
    for (const char back : held) robots(back);
    robots(c);
  }
  /// Too long for the central: of no robot where only the central speaks, a robot's otherwise.
  template <class Robots>
  void give_back(Robots&& robots) {
    const std::string held = std::exchange(held_, {});
    if (own_) return void(++cut_);
    for (const char back : held) robots(back);
  }

  link::PrefixFilter filter_;
  std::string held_;
  std::uint32_t cut_ = 0;
  bool own_ = true;  ///< since its last line only the central has spoken
  bool in_prefix_ = false;
};

}  // namespace ocm::mapper::server
