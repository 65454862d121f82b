/// A frame as a message of an MCAP file, in JSON that any tool shows: {"id":1544,"data":"00D20000"}, and what
/// is not usual behind it. Nothing of the frame is lost. Keys may come in any order and others among them.
/// No allocation.
///
/// | key | what | absent |
/// |---|---|---|
/// | `id` | identifier; of an error frame its error classes | |
/// | `data` | bytes in hexadecimal | none |
/// | `direction` | "received", "sent" | unknown |
/// | `extended`, `remote`, `error`, `fd` | kind of frame | false |
/// | `brs`, `esi` | of CAN FD: faster data, error passive sender | false |
/// | `length` | bytes that a remote frame asks for | 0 |
/// | `raw_dlc` | length code 9..15 of a classic frame of 8 bytes | the length |
/// | `time_ns` | where the message's own time does not do: text of a number below 0 | |
#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>
#include <system_error>

#include "ocm/base/swar.hpp"
#include "ocm/base/text.hpp"
#include "ocm/log/complaints.hpp"
#include "ocm/log/entry.hpp"

namespace ocm::log::mcap {

inline constexpr std::string_view frame_schema_name = "ocm.CanFrame";
inline constexpr std::string_view frame_schema =
    R"({"$schema":"https://json-schema.org/draft/2020-12/schema","title":"ocm.CanFrame",)"
    R"("description":"A CAN frame. What is absent is false, unknown or 0.","type":"object",)"
    R"("properties":{)"
    R"("id":{"type":"integer","minimum":0,"maximum":536870911,)"
    R"("description":"identifier; of an error frame its error classes, as in linux/can/error.h"},)"
    R"("data":{"type":"string","description":"bytes, two hexadecimal digits each"},)"
    R"("direction":{"type":"string","enum":["received","sent"],"description":"seen by the recorder"},)"
    R"("extended":{"type":"boolean","description":"identifier of 29 bits"},)"
    R"("remote":{"type":"boolean","description":"remote frame"},)"
    R"("error":{"type":"boolean","description":"report of the CAN controller, not a frame"},)"
    R"("fd":{"type":"boolean","description":"CAN FD"},)"
    R"("brs":{"type":"boolean","description":"CAN FD: data at the higher bit rate"},)"
    R"("esi":{"type":"boolean","description":"CAN FD: the sender is error passive"},)"
    R"("length":{"type":"integer","maximum":8,"description":"bytes that a remote frame asks for"},)"
    R"("raw_dlc":{"type":"integer","minimum":9,"maximum":15,"description":"its length code"},)"
    R"("time_ns":{"type":"string","description":"time in ns where it is before 1970"}},)"
    R"("required":["id"]})";

/// Room that `put_frame` needs.
inline constexpr std::size_t frame_room = 2 * max_fd_length + 192;

/// Writes the message at `to`; returns its end.
inline char* put_frame(char* to, const Entry& entry) noexcept {
  const auto put_number = [&to](auto number) { to = std::to_chars(to, to + 20, number).ptr; };
  to = base::swar::copy(to, R"({"id":)");
  put_number(entry.id);
  to = base::swar::copy(to, R"(,"data":")");
  for (const std::uint8_t byte : entry.bytes()) to = base::swar::hex_byte(to, byte);
  *to++ = '"';
  if (entry.direction == Direction::received) to = base::swar::copy(to, R"(,"direction":"received")");
  if (entry.direction == Direction::sent) to = base::swar::copy(to, R"(,"direction":"sent")");
  if (entry.format != can::Format::base) {
    if (can::is_extended(entry.format)) to = base::swar::copy(to, R"(,"extended":true)");
    if (can::is_remote(entry.format)) to = base::swar::copy(to, R"(,"remote":true)");
    if (entry.format == can::Format::error) to = base::swar::copy(to, R"(,"error":true)");
    if (can::is_remote(entry.format) && entry.length != 0) {
      to = base::swar::copy(to, R"(,"length":)");
      put_number(entry.length);
    }
  }
  if (entry.is_fd()) {
    to = base::swar::copy(to, R"(,"fd":true)");
    if ((entry.flags & flag::bit_rate_switch) != 0) to = base::swar::copy(to, R"(,"brs":true)");
    if ((entry.flags & flag::error_state) != 0) to = base::swar::copy(to, R"(,"esi":true)");
  }
  if (entry.raw_dlc != 0) {
    to = base::swar::copy(to, R"(,"raw_dlc":)");
    put_number(entry.raw_dlc);
  }
  if (const std::int64_t ns = entry.time.time_since_epoch().count(); ns < 0) {
    to = base::swar::copy(to, R"(,"time_ns":")");
    put_number(ns);
    *to++ = '"';
  }
  *to++ = '}';
  return to;
}

/// What reads one message. Each function: false where the text is not what it takes.
class FrameParser {
 public:
  explicit FrameParser(std::string_view text) noexcept : at_(text.data()), end_(at_ + text.size()) {}

  /// All of the entry but its interface; its time where the message says it. What is wrong, or nothing.
  [[nodiscard]] std::optional<Cause> parse(Entry& entry) noexcept {
    if (!object(entry)) return cause_;
    return assemble(entry);
  }

 private:
  bool object(Entry& entry) noexcept {
    if (!take('{')) return false;
    if (!take('}')) {
      do {
        std::string_view key;
        if (!string(key) || !take(':') || !value(key, entry)) return false;
      } while (take(','));
      if (!take('}')) return false;
    }
    skip_blanks();
    return at_ == end_;
  }

  bool value(std::string_view key, Entry& entry) noexcept {
    if (key == "id") return has_id_ = number(id_);
    if (key == "data") return data(entry);
    if (key == "direction") return direction(entry);
    if (key == "extended") return boolean(extended_);
    if (key == "remote") return boolean(remote_);
    if (key == "error") return boolean(error_);
    if (key == "fd") return boolean(fd_);
    if (key == "brs") return boolean(bit_rate_switch_);
    if (key == "esi") return boolean(error_state_);
    if (key == "length") return number(asked_);
    if (key == "raw_dlc") return number(raw_dlc_);
    if (key == "time_ns") return time(entry);
    return skip_value();
  }

  [[nodiscard]] std::optional<Cause> assemble(Entry& entry) const noexcept {
    const bool wide = extended_ || error_;
    if (!has_id_ || id_ > (wide ? can::max_extended_id : can::max_base_id)) return Cause::identifier;
    if ((error_ && (extended_ || remote_ || fd_)) || (remote_ && fd_)) return Cause::syntax;
    if (!fd_ && (bit_rate_switch_ || error_state_)) return Cause::syntax;
    if (remote_ ? size_ != 0 || asked_ > can::max_dlc : asked_ != 0) return Cause::length;
    if (fd_ ? !is_fd_length(size_) : size_ > can::max_dlc) return Cause::length;
    entry.id = id_;
    entry.format = error_       ? can::Format::error
                   : !extended_ ? (remote_ ? can::Format::base_remote : can::Format::base)
                   : remote_    ? can::Format::extended_remote
                                : can::Format::extended;
    entry.length = static_cast<std::uint8_t>(remote_ ? asked_ : size_);
    entry.flags =
        static_cast<std::uint8_t>((fd_ ? flag::fd : 0) | (bit_rate_switch_ ? flag::bit_rate_switch : 0) |
                                  (error_state_ ? flag::error_state : 0));
    const bool any_code =
        raw_dlc_ > can::max_dlc && raw_dlc_ <= 15 && entry.length == can::max_dlc && !fd_ && !error_;
    if (raw_dlc_ != 0 && !any_code) return Cause::length;
    entry.raw_dlc = static_cast<std::uint8_t>(raw_dlc_);
    entry.direction = direction_;
    for (std::size_t i = size_; i < can::max_dlc; ++i) entry.data[i] = 0;
    return std::nullopt;
  }

  void skip_blanks() noexcept {
    while (at_ != end_ && (*at_ == ' ' || *at_ == '\n' || *at_ == '\r' || *at_ == '\t')) ++at_;
  }
  bool take(char c) noexcept {
    if (at_ != end_ && *at_ == c) return ++at_, true;
    skip_blanks();
    if (at_ == end_ || *at_ != c) return false;
    ++at_;
    return true;
  }
  /// What stands between the quotes, as it stands there.
  bool string(std::string_view& text) noexcept {
    if (!take('"')) return false;
    const char* const from = at_;
    for (; at_ != end_; ++at_) {
      if (*at_ == '"') {
        text = {from, static_cast<std::size_t>(at_ - from)};
        ++at_;
        return true;
      }
      if (*at_ == '\\' && ++at_ == end_) return false;
    }
    return false;
  }
  bool number(std::uint32_t& to) noexcept {
    skip_blanks();
    const auto [end, error] = std::from_chars(at_, end_, to);
    if (error == std::errc::result_out_of_range) cause_ = Cause::identifier;
    if (error != std::errc{}) return false;
    at_ = end;
    return true;
  }
  bool boolean(bool& to) noexcept {
    skip_blanks();
    const std::string_view rest{at_, static_cast<std::size_t>(end_ - at_)};
    to = rest.starts_with("true");
    if (!to && !rest.starts_with("false")) return false;
    at_ += to ? 4 : 5;
    return true;
  }
  bool direction(Entry&) noexcept {
    std::string_view text;
    if (!string(text)) return false;
    direction_ = text == "received" ? Direction::received
                 : text == "sent"   ? Direction::sent
                                    : Direction::unknown;
    return direction_ != Direction::unknown;
  }
  bool time(Entry& entry) noexcept {
    std::string_view text;
    std::int64_t ns = 0;
    cause_ = Cause::time;
    if (!string(text)) return false;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), ns);
    if (error != std::errc{} || end != text.data() + text.size()) return false;
    cause_ = Cause::syntax;
    entry.time = base::Time{base::Duration{ns}};
    return true;
  }
  /// Four bytes a step.
  bool data(Entry& entry) noexcept {
    if (!take('"')) return false;
    size_ = 0;
    for (;;) {
      const auto left = static_cast<std::size_t>(end_ - at_);
      if (left == 0) return false;
      if (*at_ == '"') return ++at_, true;
      char text[8] = {};
      if (left >= 8) [[likely]]
        std::memcpy(text, at_, 8);
      else
        std::memcpy(text, at_, left);
      const base::swar::Hex hex = base::swar::hex(base::swar::load64(text));
      const unsigned count = hex.count();
      if (count == 0 || count % 2 != 0) return false;
      if (size_ + count / 2 > max_fd_length) {
        cause_ = Cause::length;
        return false;
      }
      const std::uint32_t bytes = hex.bytes();
      std::memcpy(entry.data.data() + size_, &bytes, count / 2);
      size_ += count / 2;
      at_ += count;
    }
  }
  /// Anything, up to the comma or brace behind it.
  bool skip_value() noexcept {
    for (std::size_t depth = 0; at_ != end_;) {
      const char c = *at_;
      if (c == '"') {
        std::string_view text;
        if (!string(text)) return false;
        continue;
      }
      if (depth == 0 && (c == ',' || c == '}')) return true;
      if (c == '{' || c == '[') ++depth;
      if (c == '}' || c == ']') {
        if (depth == 0) return false;
        --depth;
      }
      ++at_;
    }
    return false;
  }

  const char* at_;
  const char* end_;
  Cause cause_ = Cause::syntax;
  std::uint32_t id_ = 0;
  std::uint32_t asked_ = 0;
  std::uint32_t raw_dlc_ = 0;
  std::size_t size_ = 0;
  Direction direction_ = Direction::unknown;
  bool has_id_ = false;
  bool extended_ = false, remote_ = false, error_ = false;
  bool fd_ = false, bit_rate_switch_ = false, error_state_ = false;
};

/// The message of a classic data frame of 11 bits, as `put_frame` writes it, in a fraction of the time.
/// false: it is not one, or not in these characters; `entry` may have changed.
[[nodiscard]] inline bool parse_usual(std::string_view text, Entry& entry) noexcept {
  constexpr std::string_view before_id = R"({"id":)", before_data = R"(,"data":")";
  constexpr std::string_view received = R"(,"direction":"received"})", sent = R"(,"direction":"sent"})";
  const char* at = text.data();
  const char* const end = at + text.size();
  const auto left = [&] { return static_cast<std::size_t>(end - at); };
  const auto begins = [&](std::string_view with) {  // inline, which starts_with is not
    return left() >= with.size() && std::memcmp(at, with.data(), with.size()) == 0;
  };
  if (!begins(before_id)) return false;
  at += before_id.size();
  std::uint32_t id = 0;
  if (at == end || !base::is_digit(*at)) return false;
  for (int digits = 0; digits < 4 && at != end && base::is_digit(*at); ++digits, ++at)
    id = id * 10 + static_cast<std::uint32_t>(*at - '0');
  if (id > can::max_base_id || !begins(before_data)) return false;
  at += before_data.size();

  if (left() < 8) return false;
  const base::swar::Hex first = base::swar::hex(base::swar::load64(at));
  std::uint64_t data = first.bytes();
  unsigned digits = first.count();
  if (digits == 8) {
    if (left() < 16) return false;
    const base::swar::Hex second = base::swar::hex(base::swar::load64(at + 8));
    data |= std::uint64_t{second.bytes()} << 32;
    digits += second.count();
  }
  at += digits;
  if (digits % 2 != 0 || at == end || *at != '"') return false;
  ++at;
  if (left() == 1 && *at == '}')
    entry.direction = Direction::unknown;
  else if (left() == received.size() && begins(received))
    entry.direction = Direction::received;
  else if (left() == sent.size() && begins(sent))
    entry.direction = Direction::sent;
  else
    return false;
  entry.id = id;
  entry.format = can::Format::base;
  entry.length = static_cast<std::uint8_t>(digits / 2);
  entry.flags = 0;
  entry.raw_dlc = 0;
  std::memcpy(entry.data.data(), &data, sizeof data);
  return true;
}

}  // namespace ocm::log::mcap
