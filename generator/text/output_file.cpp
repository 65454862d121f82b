#include "generator/text/output_file.hpp"

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <sys/stat.h>
#include <unistd.h>

namespace ocm::generate {
namespace {

using spec::Problem;

std::optional<Problem> write_through(const std::string& path, int file, std::string_view text) {
  if (file >= 0 && write_all(file, text)) return std::nullopt;
  return Problem{path, std::strerror(errno), "a file that you may write"};
}

std::optional<Problem> replace(const std::string& path, const std::filesystem::path& target,
                               std::string_view text, std::optional<::mode_t> old_mode) {
  std::string temporary = target.string() + ".XXXXXX";
  const int file = ::mkstemp(temporary.data());
  if (file < 0)
    return Problem{path, std::string{"it cannot be written: "} + std::strerror(errno),
                   "a folder that exists and that you may write to"};
  const ::mode_t mask = ::umask(0);
  ::umask(mask);
  const ::mode_t mode = old_mode ? *old_mode : 0666U & ~mask;
  const bool written = write_all(file, text) && ::fchmod(file, mode) == 0 && ::fsync(file) == 0;
  int cause = errno;
  const bool closed = ::close(file) == 0;
  if (written && closed && std::rename(temporary.c_str(), target.c_str()) == 0) return std::nullopt;
  if (written) cause = errno;
  ::unlink(temporary.c_str());
  return Problem{path, std::string{"it cannot be written: "} + std::strerror(cause),
                 "the old one, if there was one, is as it was"};
}

}  // namespace

bool write_all(int file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t n = ::write(file, text.data(), text.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return false;
    text.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

std::optional<Problem> write_file(const std::string& path, std::string_view text) {
  if (path == "-") {
    if (write_all(STDOUT_FILENO, text)) return std::nullopt;
    return Problem{"the standard output", std::strerror(errno), "somewhere that takes the file"};
  }
  // Through links: what /dev/stdout leads to may have no path of its own.
  struct ::stat old {};
  const bool exists = ::stat(path.c_str(), &old) == 0;
  if (exists && S_ISDIR(old.st_mode))
    return Problem{path, "it is a folder", "the path of the file within it"};
  if (exists && !S_ISREG(old.st_mode)) {  // a pipe, a terminal: nothing to replace
    const int file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    auto problem = write_through(path, file, text);
    if (file >= 0) ::close(file);
    return problem;
  }
  // As far as the links lead, to what may not be there yet; no more than the file system follows.
  std::error_code error;
  std::filesystem::path target = path;
  for (int links = 0; links < 40 && std::filesystem::is_symlink(target, error); ++links)
    target = target.parent_path() / std::filesystem::read_symlink(target, error);
  if (std::filesystem::is_symlink(target, error))
    return Problem{path, std::string{"it cannot be written: "} + std::strerror(ELOOP),
                   "a link that leads to a file"};
  return replace(path, target, text, exists ? std::optional<::mode_t>{old.st_mode & 07777U} : std::nullopt);
}

}  // namespace ocm::generate
