#include "cli/fleet/line_log.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fcntl.h>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "ocm/base/text.hpp"

#include "cli/logs/file_source.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli::fleet {
namespace {

constexpr std::int64_t ns_per_us = 1000, us_per_s = 1'000'000;
/// An hour of one robot is less than a megabyte.
constexpr std::uint64_t longest_log = std::uint64_t{256} << 20;
constexpr std::int64_t latest_s = 7'258'118'400;  // 2200

/// All of a file, or as much as there is room for.
std::string read_all(std::string_view verb, const std::string& path) {
  logs::FileSource source{path};
  std::string text;
  std::array<char, 1 << 16> block;
  for (std::size_t size = source.read(block); size != 0; size = source.read(block)) {
    text.append(block.data(), size);
    if (text.size() > longest_log)
      fail({fmt::format("{}: {} is longer than {} MB", verb, path, longest_log >> 20),
            "split it: each part begins with the first line of the whole"});
  }
  if (interrupted() != 0) throw Exit{exit_code_after_interrupt(exit_failure)};
  if (!source.failure().empty())
    fail({fmt::format("{}: cannot read {}: {}", verb, path, source.failure()),
          "expected a log that --record has written"});
  return text;
}

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

LineLog::LineLog(std::string_view verb, std::string path) : verb_(verb), path_(std::move(path)) {
  file_ = host::Descriptor{::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666)};
  if (!file_)
    fail({fmt::format("{}: --record {}: {}", verb_, path_, std::strerror(errno)),
          errno == EEXIST ? "give another name: a file that is there is not overwritten"
                          : "name a file in a folder that you may write"});
  put(std::string{line_log_begins} + "\n");
}

void LineLog::write(std::string_view text) {
  if (file_ && !text.empty()) put(to_log_line(begin_ + (Clock::now() - steady_begin_), text));
}

void LineLog::put(std::string_view line) {
  const Written written = write_all(file_.get(), line);
  if (written.bytes == line.size()) return;
  complain({fmt::format("{}: {}: {}; what the robots say from now on is not recorded", verb_, path_,
                        std::strerror(written.error)),
            "make room on the disk, and start again"});
  file_.reset();
}

bool is_line_log(const std::string& path) {
  const host::Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
  std::array<char, line_log_begins.size() + 1> begin{};
  const ssize_t size = file ? ::read(file.get(), begin.data(), begin.size()) : 0;
  return size == static_cast<ssize_t>(begin.size()) && begin.back() == '\n' &&
         std::string_view{begin.data(), line_log_begins.size()} == line_log_begins;
}

ReadLineLog read_line_log(std::string_view verb, const std::string& path) {
  const std::string all = read_all(verb, path);
  std::string_view rest = all;
  const auto next = [&rest] {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(rest.size(), line.size() + 1));
    return line;
  };
  if (next() != line_log_begins)
    fail({fmt::format("{}: {} is no log of a central's line", verb, path),
          "map --record and central --own --record write one"});
  ReadLineLog log;
  for (std::uint64_t number = 2; !rest.empty(); ++number) {
    const bool whole = rest.find('\n') != std::string_view::npos;  // else its writer was ended
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
