/// Keys as they are pressed, one by one and without being shown, from the terminal that stdin is; what a
/// picture needs besides is in cli/top/curses.hpp.
#pragma once

#include <cerrno>
#include <cstddef>
#include <optional>
#include <string_view>
#include <termios.h>
#include <unistd.h>

namespace ocm::cli {

/// As long as it lives. Signals of the terminal (Ctrl-C, Ctrl-Z) stay signals.
class KeyInput {
 public:
  KeyInput() noexcept {
    if (::tcgetattr(STDIN_FILENO, &before_) != 0) return;
    termios now = before_;
    now.c_lflag &= ~tcflag_t{ICANON | ECHO};
    now.c_cc[VMIN] = 0;
    now.c_cc[VTIME] = 0;
    is_terminal_ = ::tcsetattr(STDIN_FILENO, TCSANOW, &now) == 0;
  }
  ~KeyInput() {
    if (is_terminal_) ::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
  }
  KeyInput(const KeyInput&) = delete;
  KeyInput& operator=(const KeyInput&) = delete;

  [[nodiscard]] bool is_terminal() const noexcept { return is_terminal_; }
  /// What was pressed since it was asked last, until it is asked again; nothing: the terminal is gone.
  [[nodiscard]] std::optional<std::string_view> read() noexcept {
    const ssize_t count = ::read(STDIN_FILENO, buffer_, sizeof buffer_);
    if (count > 0) return std::string_view{buffer_, static_cast<std::size_t>(count)};
    if (count < 0)
      return errno == EAGAIN || errno == EINTR ? std::optional{std::string_view{}} : std::nullopt;
    return std::string_view{};  // no key, with VMIN 0; a terminal that is closed says EIO, or sends SIGHUP
  }

 private:
  termios before_{};
  bool is_terminal_ = false;
  char buffer_[64] = {};
};

}  // namespace ocm::cli
