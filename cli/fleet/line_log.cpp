#include "cli/fleet/line_log.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

#include <fmt/format.h>

#include "ocm/base/text.hpp"

namespace ocm::cli::fleet {
namespace {

constexpr std::int64_t ns_per_us = 1000, us_per_s = 1'000'000;
constexpr std::int64_t latest_s = 7'258'118'400;  // 2200

}  // namespace

std::string to_log_line(base::Time time, std::string_view text) {
  const std::int64_t us = time.time_since_epoch().count() / ns_per_us;
  std::string line = fmt::format("({}.{:06}) ", us / us_per_s, us % us_per_s);
  for (const char c : text) {
    if (c < ' ' || c > '~' || c == '\\')
      line += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    else
      line += c;
  }
  return line += '\n';
}

std::optional<Said> parse_log_line(std::string_view line) {
  constexpr std::size_t decimals = 6;
  const std::size_t point = line.find('.');
  const std::size_t end = line.find(") ");
  if (!line.starts_with('(') || end == std::string_view::npos || point == std::string_view::npos ||
      end != point + 1 + decimals)
    return std::nullopt;
  const auto whole = [](std::string_view digits, std::int64_t& number) {
    const char* const last = digits.data() + digits.size();
    const auto [to, error] = std::from_chars(digits.data(), last, number);
    return error == std::errc{} && to == last && number >= 0 && digits.front() != '-';
  };
  std::int64_t seconds = 0, us = 0;
  const std::string_view before = line.substr(1, point - 1);
  if (before.empty() || !whole(before, seconds) || !whole(line.substr(point + 1, decimals), us) ||
      seconds > latest_s)
    return std::nullopt;
  Said said{base::Time{base::Duration{(seconds * us_per_s + us) * ns_per_us}}, {}};
  for (std::string_view text = line.substr(end + 2); !text.empty();) {
    if (text[0] < ' ' || text[0] > '~') return std::nullopt;
    if (text[0] != '\\') {
      said.text += text[0];
      text.remove_prefix(1);
      continue;
    }
    if (text.size() < 4 || text[1] != 'x') return std::nullopt;
    const int high = base::hex_digit(text[2]), low = base::hex_digit(text[3]);
    if (high < 0 || low < 0) return std::nullopt;
    said.text += static_cast<char>(16 * high + low);
    text.remove_prefix(4);
  }
  return said;
}

std::optional<ReadLineLog> parse_line_log(std::string_view text) {
  const auto next = [&text] {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    return line;
  };
  if (next() != line_log_begins) return std::nullopt;
  ReadLineLog log;
  for (std::uint64_t number = 2; !text.empty(); ++number) {
    const bool whole = text.find('\n') != std::string_view::npos;  // else its writer was ended
    auto said = parse_log_line(next());
    if (said && whole && (log.said.empty() || said->time >= log.said.back().time)) {
      log.said.push_back(std::move(*said));
    } else if (log.damaged++ == 0) {
      log.first_damaged = number;
    }
  }
  return log;
}

}  // namespace ocm::cli::fleet
