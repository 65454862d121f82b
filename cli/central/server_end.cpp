#include "cli/central/server_end.hpp"

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstring>
#include <unistd.h>
#include <utility>

#include "cli/shared/messages.hpp"

namespace ocm::cli::central {
namespace {

[[nodiscard]] bool ready(int descriptor, short event) {
  pollfd line{descriptor, event, 0};
  return ::poll(&line, 1, 0) > 0;
}

/// Both may be shared with other programs, so that they stay as they are, and may block: asked before each
/// use.
class StandardStreams final : public ServerEnd {
 public:
  [[nodiscard]] bool attached() override {
    pollfd output{STDOUT_FILENO, 0, 0};
    if (::poll(&output, 1, 0) > 0 && (output.revents & POLLERR) != 0) broken_ = true;
    return !broken_;
  }
  [[nodiscard]] bool over() const override { return ended_ || broken_; }
  std::size_t read(std::span<char> room) override {
    if (over() || !ready(STDIN_FILENO, POLLIN)) return 0;
    const ssize_t size = ::read(STDIN_FILENO, room.data(), room.size());
    if (size > 0) return static_cast<std::size_t>(size);
    ended_ = size == 0 || (errno != EINTR && errno != EAGAIN);
    return 0;
  }
  std::size_t write(std::string_view text) override {
    // A pipe that is ready has room for that much.
    std::size_t taken = 0;
    while (taken < text.size() && !broken_ && ready(STDOUT_FILENO, POLLOUT)) {
      const std::string_view part = text.substr(taken, PIPE_BUF);
      const ssize_t size = ::write(STDOUT_FILENO, part.data(), part.size());
      if (size < 0 && (errno == EINTR || errno == EAGAIN)) break;
      if (size < 0 && errno != EPIPE)
        fail({std::string("cannot write to the standard output: ") + std::strerror(errno), ""});
      if (size < 0) broken_ = true;  // its reader has gone
      taken += static_cast<std::size_t>(std::max<ssize_t>(size, 0));
    }
    return taken;
  }
  void watch(std::vector<pollfd>& inputs, bool reads, bool writes) const override {
    if (reads && !over()) inputs.push_back({STDIN_FILENO, POLLIN, 0});
    // No event asked for: only that its reader has gone.
    if (!broken_) inputs.push_back({STDOUT_FILENO, static_cast<short>(writes ? POLLOUT : 0), 0});
  }

 private:
  bool ended_ = false;
  bool broken_ = false;
};

class PseudoTerminal final : public ServerEnd {
 public:
  explicit PseudoTerminal(transport::Pty pty) : pty_(std::move(pty)) {}
  [[nodiscard]] bool attached() override { return attached_ = pty_.attached(); }
  [[nodiscard]] bool over() const override { return false; }
  std::size_t read(std::span<char> room) override { return pty_.read(room); }
  std::size_t write(std::string_view text) override { return pty_.write(text); }
  void watch(std::vector<pollfd>& inputs, bool reads, bool writes) const override {
    if (attached_)
      inputs.push_back(
          {pty_.descriptor(), static_cast<short>((reads ? POLLIN : 0) | (writes ? POLLOUT : 0)), 0});
  }

 private:
  transport::Pty pty_;
  bool attached_ = false;
};

}  // namespace

std::unique_ptr<ServerEnd> standard_streams() {
  return std::make_unique<StandardStreams>();
}
std::unique_ptr<ServerEnd> pseudo_terminal(transport::Pty pty) {
  return std::make_unique<PseudoTerminal>(std::move(pty));
}

}  // namespace ocm::cli::central
