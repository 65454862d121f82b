#include "cli/logs/file_source.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cli/shared/interrupt.hpp"

namespace ocm::cli::logs {

FileSource::FileSource(const std::string& path, Reading reading) : reading_(reading) {
  descriptor_ = path == "-" ? STDIN_FILENO : ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  if (descriptor_ < 0 || fstat(descriptor_, &status) != 0) {
    failure_ = std::strerror(errno);
  } else if (S_ISDIR(status.st_mode)) {
    failure_ = std::strerror(EISDIR);
  } else if (S_ISREG(status.st_mode)) {
    size_ = static_cast<std::uint64_t>(status.st_size);
    posix_fadvise(descriptor_, 0, 0, POSIX_FADV_SEQUENTIAL);
  }
}

FileSource::~FileSource() {
  if (descriptor_ > STDIN_FILENO) ::close(descriptor_);
}

std::string_view FileSource::beginning() {
  while (head_end_ < sizeof head_) {
    const std::size_t count = read_some(std::span{head_}.subspan(head_end_));
    if (count == 0) break;
    head_end_ += count;
  }
  return {head_, head_end_};
}

std::size_t FileSource::read(std::span<char> into) {
  if (head_begin_ == head_end_) return read_some(into);
  const std::size_t count = std::min(into.size(), head_end_ - head_begin_);
  std::memcpy(into.data(), head_ + head_begin_, count);
  head_begin_ += count;
  return count;
}

bool FileSource::cut_off() const {
  return reading_ == Reading::until_a_signal && interrupted() != 0;
}

std::size_t FileSource::read_some(std::span<char> into) {
  for (;;) {
    if (!failure_.empty()) return 0;
    if (cut_off()) {
      failure_ = "interrupted";
      return 0;
    }
    const ssize_t count = ::read(descriptor_, into.data(), into.size());
    if (count == 0 && cut_off()) continue;  // the program at the other end got the signal, too
    if (count >= 0) {
      position_ += static_cast<std::uint64_t>(count);
      return static_cast<std::size_t>(count);
    }
    if (errno != EINTR) failure_ = std::strerror(errno);
  }
}

WholeFile read_file(const std::string& path, std::size_t most) {
  FileSource source{path};
  WholeFile file;
  std::array<char, 1 << 16> block;
  for (std::size_t size = source.read(block); size != 0; size = source.read(block)) {
    file.text.append(block.data(), size);
    if (file.text.size() > most) return {{}, {}, true};
  }
  file.failure = source.failure();
  return file;
}

}  // namespace ocm::cli::logs
