#include "cli/output/printer.hpp"

#include <cerrno>
#include <cstring>
#include <unistd.h>

#include "cli/session.hpp"

namespace ocm::cli {

void Printer::flush() {
  std::string_view left = buffer_.view();
  while (!left.empty()) {
    const ssize_t written = ::write(STDOUT_FILENO, left.data(), left.size());
    if (written >= 0) {
      left.remove_prefix(static_cast<std::size_t>(written));
      continue;
    }
    if (errno == EINTR || errno == EAGAIN) continue;
    const int error = errno;
    buffer_.clear();
    fail({fmt::format("cannot write the output: {}", std::strerror(error)),
          "is the disk full, or was the file closed?"});
  }
  buffer_.clear();
}

}  // namespace ocm::cli
