#include "cli/output/printer.hpp"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <unistd.h>

#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli {

void write_out(std::string_view text) {
  const int error = write_all(STDOUT_FILENO, text).error;
  if (error == EPIPE && interrupted() == SIGPIPE) throw Exit{exit_code_after_interrupt(exit_failure)};
  if (error == EINTR)
    fail({"interrupted: the reader of the output takes no more of it", "the rest of it is lost"},
         exit_code_after_interrupt(exit_failure));
  if (error != 0)
    fail({fmt::format("cannot write the output: {}", std::strerror(error)),
          "is the disk full, or was the file closed?"});
}

void write_out(Buffer& buffer) {
  const std::string_view text = buffer.view();
  buffer.clear();  // the bytes stay where they are
  write_out(text);
}

}  // namespace ocm::cli
