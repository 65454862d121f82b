/// The side of the server: this program's own input and output, for a person or a program that has started
/// it; or a pseudo terminal, for a program that expects a dongle's serial line and comes and goes.
#pragma once

#include <cstddef>
#include <memory>
#include <poll.h>
#include <span>
#include <string_view>
#include <vector>

#include "ocm/transport/pty.hpp"

namespace ocm::cli::central {

class ServerEnd {
 public:
  ServerEnd() = default;
  ServerEnd(const ServerEnd&) = delete;
  ServerEnd& operator=(const ServerEnd&) = delete;
  virtual ~ServerEnd() = default;

  /// Whether a server has the line open. What is sent while none has is lost.
  [[nodiscard]] virtual bool attached() = 0;
  /// No server can come any more.
  [[nodiscard]] virtual bool over() const = 0;
  /// What has come, the first of `room`; never waits.
  virtual std::size_t read(std::span<char> room) = 0;
  /// How much of it was taken, the first bytes; never waits. Ends the command, in words, when it cannot be
  /// written at all (a full disk).
  virtual std::size_t write(std::string_view text) = 0;
  /// What to wait for: input if `reads`, room for output if `writes`.
  virtual void watch(std::vector<pollfd>& inputs, bool reads, bool writes) const = 0;
};

[[nodiscard]] std::unique_ptr<ServerEnd> standard_streams();
[[nodiscard]] std::unique_ptr<ServerEnd> pseudo_terminal(transport::Pty pty);

}  // namespace ocm::cli::central
