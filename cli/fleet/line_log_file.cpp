#include "cli/fleet/line_log_file.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "cli/logs/file_source.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli::fleet {
namespace {

/// An hour of one robot is less than a megabyte.
constexpr std::size_t longest_log = std::size_t{256} << 20;

std::string read_all(std::string_view verb, const std::string& path) {
  auto file = logs::read_file(path, longest_log);
  if (file.too_long)
    fail({fmt::format("{}: {} is longer than {} MB", verb, path, longest_log >> 20),
          "split it: each part begins with the first line of the whole"});
  if (interrupted() != 0) throw Exit{exit_code_after_interrupt(exit_failure)};
  if (!file.failure.empty())
    fail({fmt::format("{}: cannot read {}: {}", verb, path, file.failure),
          "expected a log that --record has written"});
  return std::move(file.text);
}

}  // namespace

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
  auto log = parse_line_log(read_all(verb, path));
  if (!log)
    fail({fmt::format("{}: {} is no log of a central's line", verb, path),
          "map --record and central --own --record write one"});
  return std::move(*log);
}

}  // namespace ocm::cli::fleet
