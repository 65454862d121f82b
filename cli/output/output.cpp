#include "cli/output/output.hpp"

#include <cerrno>
#include <cstring>
#include <unistd.h>

#include "cli/session.hpp"

namespace ocm::cli {

std::unique_ptr<Output> make_output(Format format, const protocol::Catalogue& catalogue, bool colour) {
  switch (format) {
    case Format::json:
      return make_json(catalogue);
    case Format::csv:
      return make_csv();
    case Format::raw:
      return make_raw();
    case Format::pretty:
      break;
  }
  return make_pretty(catalogue, colour);
}

void Printer::flush() {
  const char* data = buffer_.data();
  std::size_t left = buffer_.size();
  while (left > 0) {
    const ssize_t written = ::write(STDOUT_FILENO, data, left);
    if (written < 0) {
      if (errno == EINTR || errno == EAGAIN) continue;
      const int error = errno;
      buffer_.clear();
      fail({fmt::format("cannot write the output: {}", std::strerror(error)),
            "is the disk full, or was the file closed?"});
    }
    data += written;
    left -= static_cast<std::size_t>(written);
  }
  buffer_.clear();
}

}  // namespace ocm::cli
