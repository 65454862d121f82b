#include "cli/output/printer.hpp"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <unistd.h>

#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/unhurried_messages.hpp"

namespace ocm::cli {

namespace {

/// After a write: leaves if not all was written, for good.
void leave_after(int error) {
  if (error == EPIPE && interrupted() == SIGPIPE) throw Exit{exit_code_after_interrupt(exit_failure)};
  if (error == EINTR)
    fail({"interrupted: the reader of the output takes no more of it", "the rest of it is lost"},
         exit_code_after_interrupt(exit_failure));
  if (error != 0)
    fail({fmt::format("cannot write the output: {}", std::strerror(error)),
          "is the disk full, or was the file closed?"});
}

}  // namespace

void write_out(std::string_view text) {
  leave_after(write_all(STDOUT_FILENO, text).error);
}

void write_out(Buffer& buffer) {
  const std::string_view text = buffer.view();
  buffer.clear();  // the bytes stay where they are
  write_out(text);
}

void Printer::flush() {
  const std::string_view rest = buffer_.view().substr(written_);
  written_ = 0;
  buffer_.clear();  // the bytes stay where they are
  write_out(rest);
}

bool Printer::flush_now() {
  const Written written = write_now(STDOUT_FILENO, buffer_.view().substr(written_));
  leave_after(written.error);
  written_ += written.bytes;
  if (written_ < buffer_.size()) return false;
  buffer_.clear();
  written_ = 0;
  return true;
}

}  // namespace ocm::cli
