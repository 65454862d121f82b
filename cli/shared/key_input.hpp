/// Keys as they are pressed, one by one and without being shown, from the terminal that stdin is; what a
/// picture needs besides is in cli/top/curses.hpp.
#pragma once

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <optional>
#include <poll.h>
#include <string_view>
#include <termios.h>
#include <unistd.h>
#include <utility>

namespace ocm::cli {

/// As long as it lives. Signals of the terminal (Ctrl-C, Ctrl-Z) stay signals.
class KeyInput {
 public:
  KeyInput() noexcept { is_terminal_ = ::tcgetattr(STDIN_FILENO, &before_) == 0 && take_keys(); }
  ~KeyInput() {
    if (is_terminal_) ::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
  }
  KeyInput(const KeyInput&) = delete;
  KeyInput& operator=(const KeyInput&) = delete;

  [[nodiscard]] bool is_terminal() const noexcept { return is_terminal_; }
  /// What was pressed since it was asked last, until it is asked again; nothing: the terminal is gone. The
  /// beginning of a sequence of a key, such as an arrow's, is kept for some looks: its end may be on its way.
  [[nodiscard]] std::optional<std::string_view> read() noexcept {
    constexpr unsigned looks_for_the_end = 6;
    std::memmove(buffer_, buffer_ + given_, kept_);
    given_ = 0;
    keep_keys();
    const short seen = seen_now();
    if (seen == 0) {
      if (kept_ != 0 && ++looks_ == looks_for_the_end) given_ = std::exchange(kept_, 0);
      return std::string_view{buffer_, given_};
    }
    const ssize_t count = ::read(STDIN_FILENO, buffer_ + kept_, sizeof buffer_ - kept_);
    if (count < 0 && errno != EAGAIN && errno != EINTR) return std::nullopt;  // closed: EIO, or SIGHUP
    if (count == 0 && (seen & POLLHUP) != 0) return std::nullopt;  // what a closed one may say, too
    if (count > 0) {
      const std::size_t all = kept_ + static_cast<std::size_t>(count);
      kept_ = begun({buffer_, all});
      given_ = all - kept_;
      looks_ = 0;
    }
    return std::string_view{buffer_, given_};
  }

 private:
  [[nodiscard]] bool take_keys() const noexcept {
    termios now = before_;
    now.c_lflag &= ~tcflag_t{ICANON | ECHO};
    now.c_cc[VMIN] = 0;
    now.c_cc[VTIME] = 0;
    return ::tcsetattr(STDIN_FILENO, TCSANOW, &now) == 0;
  }
  /// A shell gives a program that was stopped the terminal back as it is for the shell, line by line.
  void keep_keys() const noexcept {
    termios now{};
    if (::tcgetattr(STDIN_FILENO, &now) != 0 || (now.c_lflag & ICANON) == 0) return;
    // In the background it is the shell's, and a change of ours would stop us. -1: no program owns it.
    const pid_t owner = ::tcgetpgrp(STDIN_FILENO);
    if (owner == -1 || owner == ::getpgrp()) (void)take_keys();
  }
  /// What can be seen of the terminal without waiting; 0: nothing was pressed.
  [[nodiscard]] static short seen_now() noexcept {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    return ::poll(&input, 1, 0) == 1 ? input.revents : short{0};
  }
  /// How many bytes at the end are the beginning of a sequence.
  [[nodiscard]] static std::size_t begun(std::string_view text) noexcept {
    const std::size_t at = text.rfind('\x1b');
    if (at == text.npos) return 0;
    const std::string_view sequence = text.substr(at);
    constexpr std::size_t longest = 16;
    if (sequence.size() > longest) return 0;
    if (sequence.size() > 1 && sequence[1] != '[' && sequence[1] != 'O') return 0;
    for (const char c : sequence.substr(std::min<std::size_t>(sequence.size(), 2)))
      if (c >= '@' && c <= '~') return 0;
    return sequence.size();
  }

  termios before_{};
  bool is_terminal_ = false;
  char buffer_[64] = {};
  std::size_t given_ = 0;  ///< bytes
  std::size_t kept_ = 0;   ///< behind those
  unsigned looks_ = 0;     ///< since they came
};

}  // namespace ocm::cli
