/// Comma-separated logs as python-can's CSVWriter writes and its CSVReader reads them: a head line, then
/// `timestamp,arbitration_id,extended,remote,error,dlc,data` with the data in base64. Constant memory, no
/// allocation a frame.
///
/// The format has no column for CAN FD, for the interface and for the direction. A row of more than 8 bytes
/// is read as a CAN FD frame, for it can be no other; every frame is of interface can0. Times may have an
/// exponent (Python writes 5e-05) and more digits than nanoseconds need.
/// [python-can 4.1.0, can/io/csv.py]
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string_view>

#include "ocm/base/decimal.hpp"
#include "ocm/base/swar.hpp"
#include "ocm/base/text.hpp"
#include "ocm/log/reader.hpp"
#include "ocm/log/writer.hpp"

namespace ocm::log {

namespace csv {

inline constexpr std::string_view head = "timestamp,arbitration_id,extended,remote,error,dlc,data";

inline constexpr char base64_digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
inline constexpr std::size_t max_base64 = (max_fd_length + 2) / 3 * 4;

/// [RFC 4648, 4] Returns the place behind.
inline char* to_base64(char* at, std::span<const std::uint8_t> bytes) noexcept {
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = bytes.size() - i;
    const std::uint32_t word = static_cast<std::uint32_t>(bytes[i]) << 16 |
                               (left > 1 ? static_cast<std::uint32_t>(bytes[i + 1]) << 8 : 0) |
                               (left > 2 ? bytes[i + 2] : std::uint32_t{0});
    *at++ = base64_digits[word >> 18];
    *at++ = base64_digits[word >> 12 & 63];
    *at++ = left > 1 ? base64_digits[word >> 6 & 63] : '=';
    *at++ = left > 2 ? base64_digits[word & 63] : '=';
  }
  return at;
}

/// How many bytes; nothing if `text` is no base64, or of more than 64 bytes.
[[nodiscard]] inline std::optional<std::size_t> from_base64(
    std::string_view text, std::array<std::uint8_t, max_fd_length>& out) noexcept {
  static constexpr auto values = [] {
    std::array<std::int8_t, 256> table{};
    table.fill(-1);
    for (int i = 0; i < 64; ++i)
      table[static_cast<unsigned char>(base64_digits[i])] = static_cast<std::int8_t>(i);
    return table;
  }();
  if (text.size() % 4 != 0 || text.size() > max_base64) return std::nullopt;
  std::size_t padding = 0;
  while (padding < 2 && !text.empty() && text.back() == '=') {
    text.remove_suffix(1);
    ++padding;
  }
  const std::size_t size = text.size() * 3 / 4;
  if (size > out.size()) return std::nullopt;
  std::uint32_t bits = 0;
  std::size_t count = 0, done = 0;
  for (const char c : text) {
    const int value = values[static_cast<unsigned char>(c)];
    if (value < 0) return std::nullopt;
    bits = bits << 6 | static_cast<std::uint32_t>(value);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    out[done++] = static_cast<std::uint8_t>(bits >> count);
  }
  return size;
}

/// Up to the next comma, which is taken too.
[[nodiscard]] constexpr std::string_view take_cell(std::string_view& row) noexcept {
  const auto comma = row.find(',');
  const std::string_view cell = row.substr(0, comma);
  row.remove_prefix(comma == std::string_view::npos ? row.size() : comma + 1);
  return cell;
}

[[nodiscard]] constexpr std::optional<base::Time> parse_time(std::string_view text) noexcept {
  const auto seconds = base::parse_decimal(text);
  if (!seconds) {
    // More digits than 63 bits hold: those behind the ninth of the fraction say nothing here.
    const auto point = text.find('.');
    if (point == std::string_view::npos || text.size() <= point + 10) return std::nullopt;
    if (text.find_first_not_of("0123456789", point + 1) != std::string_view::npos) return std::nullopt;
    return parse_time(text.substr(0, point + 10));
  }
  const auto ns = base::divide_rounded(*seconds, base::Decimal{1, -9});
  if (!ns) return std::nullopt;
  return base::Time{base::Duration{*ns}};
}

/// A row as an entry; or what is wrong with it.
[[nodiscard]] inline std::optional<Cause> parse_row(std::string_view row, Entry& entry) noexcept {
  entry = Entry{};
  const auto time = parse_time(take_cell(row));
  std::string_view id_text = take_cell(row);
  if (id_text.starts_with("0x")) id_text.remove_prefix(2);
  const auto id = base::parse_unsigned(id_text, 16);
  const std::string_view flags[3] = {take_cell(row), take_cell(row), take_cell(row)};
  const auto length = base::parse_unsigned(take_cell(row));
  if (!length || row.find(',') != std::string_view::npos) return Cause::syntax;
  for (const std::string_view flag : flags)
    if (flag != "0" && flag != "1") return Cause::syntax;
  const auto is_set = [](std::string_view flag) { return flag == "1"; };
  if (!time) return Cause::time;
  entry.time = *time;
  const bool extended = is_set(flags[0]), remote = is_set(flags[1]), error = is_set(flags[2]);
  if (error && remote) return Cause::syntax;
  if (!id || *id > (extended || error ? can::max_extended_id : can::max_base_id)) return Cause::identifier;
  entry.id = static_cast<std::uint32_t>(*id);
  entry.format = error      ? can::Format::error
                 : remote   ? (extended ? can::Format::extended_remote : can::Format::base_remote)
                 : extended ? can::Format::extended
                            : can::Format::base;
  const auto size = from_base64(row, entry.data);
  if (!size) return Cause::syntax;
  const bool fd = *length > can::max_dlc;
  if (*length > max_fd_length || (remote ? *size != 0 : *size != *length)) return Cause::length;
  if (fd && (remote || error || !is_fd_length(static_cast<std::size_t>(*length)))) return Cause::length;
  entry.length = static_cast<std::uint8_t>(*length);
  if (fd) entry.flags = flag::fd;
  return std::nullopt;
}

}  // namespace csv

class CsvReader final : public Reader {
 public:
  using Reader::Reader;

  [[nodiscard]] static bool recognises(std::string_view beginning) {
    return beginning.starts_with(csv::head);
  }

  [[nodiscard]] std::size_t read(std::span<Entry> into) override {
    std::size_t count = 0;
    while (count < into.size()) {
      std::string_view row;
      const auto taken = input_->take_line(row, count == 0 ? Input::Wait::yes : Input::Wait::no);
      const Place place{input_->line_number(), true};
      if (taken == Input::Line::later || taken == Input::Line::none) break;
      if (taken == Input::Line::last && !input_->failure().empty()) {  // half a row may look like a whole one
        complain(Cause::truncated, place, row);
        break;
      }
      if (row.empty() || (place.number == 1 && row == csv::head)) continue;
      const auto wrong = taken == Input::Line::too_long ? Cause::too_long : csv::parse_row(row, into[count]);
      if (wrong)
        complain(cause_of_line(*wrong, taken), place, row);
      else
        into[count++].interface = interfaces_.number("can0");
    }
    return count;
  }
};

/// Counts as lost what the columns have no room for.
class CsvWriter final : public Writer {
 public:
  void begin(Bytes& out) override {
    out.append(csv::head);
    out.append('\n');
  }

  void write(Bytes& out, std::span<const Entry> entries, const Interfaces& interfaces) override {
    for (const Entry& entry : entries) {
      if (!interfaces.name(entry.interface).empty()) losses_.add(Lost::interface);
      count_losses(entry);
      char* const begin = out.room(longest_row);
      out.grow_to(row(begin, entry));
    }
  }

 private:
  static constexpr std::size_t longest_row = 22 + 11 + 6 + 4 + csv::max_base64 + 8;

  void count_losses(const Entry& entry) noexcept {
    if (entry.direction != Direction::unknown) losses_.add(Lost::direction);
    if (entry.raw_dlc != 0) losses_.add(Lost::raw_dlc);
    // Over 8 bytes the length alone tells that it is CAN FD.
    if (entry.is_fd() && (entry.length <= can::max_dlc || entry.flags != flag::fd))
      losses_.add(Lost::fd_flags);
  }

  static char* row(char* at, const Entry& entry) noexcept {
    at = time(at, entry.time.time_since_epoch().count());
    at = identifier(at, entry.id);
    const bool wide = can::is_extended(entry.format) || entry.format == can::Format::error;
    for (const bool set : {wide, can::is_remote(entry.format), entry.format == can::Format::error}) {
      *at++ = ',';
      *at++ = set ? '1' : '0';
    }
    *at++ = ',';
    if (entry.length >= 10) *at++ = static_cast<char>('0' + entry.length / 10);
    *at++ = static_cast<char>('0' + entry.length % 10);
    *at++ = ',';
    at = csv::to_base64(at, entry.bytes());
    *at++ = '\n';
    return at;
  }

  /// Six digits of a second, nine where they say more.
  static char* time(char* at, std::int64_t ns) noexcept {
    if (ns < 0) *at++ = '-';
    const std::uint64_t whole = base::detail::magnitude(ns);
    const std::uint64_t seconds = whole / 1'000'000'000;
    const auto fraction = static_cast<std::uint32_t>(whole % 1'000'000'000);
    char text[10];
    base::swar::eight_digits(base::swar::two_digits(text, static_cast<std::uint32_t>(seconds / 100'000'000)),
                             static_cast<std::uint32_t>(seconds % 100'000'000));
    const std::string_view digits{text, sizeof text};
    at = base::swar::copy(at, digits.substr(std::min(digits.find_first_not_of('0'), digits.size() - 1)));
    *at++ = '.';
    at = base::swar::eight_digits(at, fraction / 10);
    *at++ = static_cast<char>('0' + fraction % 10);
    return fraction % 1000 == 0 ? at - 3 : at;
  }

  static char* identifier(char* at, std::uint32_t id) noexcept {
    at = base::swar::copy(at, ",0x");
    int shift = 28;
    while (shift > 0 && id >> shift == 0) shift -= 4;
    for (; shift >= 0; shift -= 4) *at++ = "0123456789abcdef"[id >> shift & 0xF];
    return at;
  }
};

}  // namespace ocm::log
