#include "generator/spec/file.hpp"

#include <algorithm>
#include <cerrno>
#include <fcntl.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

#include "ocm/base/text.hpp"

namespace ocm::spec {
namespace {

/// The bytes of a file, and of one that is too large one more than is allowed: a device has no end. Nothing:
/// it cannot be read.
std::optional<std::string> read_all(int file, std::size_t most) {
  std::string text;
  // A file says how long it is, and one byte more says that it has ended.
  struct stat known {};
  const bool is_file = ::fstat(file, &known) == 0 && S_ISREG(known.st_mode) && known.st_size > 0;
  std::size_t room = is_file ? static_cast<std::size_t>(known.st_size) + 1 : 64 * 1024;
  while (text.size() <= most) {
    const std::size_t size = text.size();
    text.resize(std::min(std::max(size + 1, room), most + 1));
    room = 2 * text.size();
    ssize_t n = 0;
    do n = ::read(file, text.data() + size, text.size() - size);
    while (n < 0 && errno == EINTR);
    if (n < 0) return std::nullopt;
    text.resize(size + static_cast<std::size_t>(n));
    if (n == 0) break;
  }
  return text;
}

}  // namespace

std::optional<std::string> read_document(const std::filesystem::path& file, std::string_view what,
                                         std::string_view example, std::vector<Problem>& problems,
                                         std::size_t most) {
  const auto failed = [&](std::string problem, std::string remedy) {
    problems.push_back({file.string(), std::move(problem), std::move(remedy)});
    return std::nullopt;
  };
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status))
    return failed(
        error && error != std::errc::no_such_file_or_directory ? error.message() : "there is no such file",
        "the path of " + std::string{what} + ", such as " + std::string{example});
  if (std::filesystem::is_directory(status))
    return failed("it is a folder",
                  "the path of the " + std::string{what.substr(what.find(' ') + 1)} + " within it");
  // No stream: it takes memory of its own, and reports that there is none as a file that cannot be opened.
  const int in = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (in < 0) return failed("it cannot be opened", "a file that you may read");
  auto text = read_all(in, most);
  ::close(in);
  if (!text) return failed("it cannot be read", "a readable file");
  if (text->size() > most)
    return failed("the file is larger than " + std::to_string(most) + " bytes",
                  std::string{what} + " is smaller");
  return text;
}

bool has_document(const std::vector<Problem>& problems) {
  const auto has_path = [](const Problem& p) { return p.place.find(": /") != std::string::npos; };
  return std::all_of(problems.begin(), problems.end(), has_path);
}

void sort_by_line(std::vector<Problem>& problems, std::string_view file_name) {
  const auto line_of = [&](const Problem& p) {
    std::size_t line = 0;  // places begin "file:line"
    for (std::size_t i = file_name.size() + 1; i < p.place.size() && base::is_digit(p.place[i]); ++i)
      line = 10 * line + static_cast<std::size_t>(p.place[i] - '0');
    return line;
  };
  std::stable_sort(problems.begin(), problems.end(),
                   [&](const Problem& a, const Problem& b) { return line_of(a) < line_of(b); });
}

}  // namespace ocm::spec
