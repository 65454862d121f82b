/// Messages (cli/shared/messages.hpp) of a program that others need: it must not wait for a terminal after
/// Ctrl-S, or for a pager.
#pragma once

#include <string_view>

#include "cli/shared/interrupt.hpp"

namespace ocm::cli {

/// As long as one lives, no message waits for who reads stderr. What is not taken at once is kept, and
/// written by the next message or `write`; at the end for a second at most, and the rest is lost. Beyond 1000
/// kept ones new messages are counted, and the count is reported. Of any thread.
class UnhurriedMessages {
 public:
  UnhurriedMessages();
  ~UnhurriedMessages();
  UnhurriedMessages(const UnhurriedMessages&) = delete;
  UnhurriedMessages& operator=(const UnhurriedMessages&) = delete;
  /// Writes what stderr takes now. Cheap where nothing is kept.
  static void write();
};

/// The same from now on, to the program's end.
void never_wait_for_messages();

/// Writes to stdout or stderr as much as it takes without a wait. Fewer bytes and no error: it has no room
/// now.
[[nodiscard]] Written write_now(int descriptor, std::string_view text);

}  // namespace ocm::cli
