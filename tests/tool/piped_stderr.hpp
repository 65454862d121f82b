/// Standard error as a pipe, which takes nothing once it is full.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <fcntl.h>
#include <string>
#include <sys/types.h>
#include <unistd.h>

#include <catch2/catch.hpp>

namespace ocm::test {

/// As long as it lives.
class PipedStderr {
 public:
  PipedStderr() : before_(::dup(STDERR_FILENO)) {
    REQUIRE(::pipe2(ends_.data(), O_CLOEXEC) == 0);
    REQUIRE(::dup2(ends_[1], STDERR_FILENO) == STDERR_FILENO);
    REQUIRE(::fcntl(ends_[0], F_SETFL, O_NONBLOCK) == 0);
  }
  ~PipedStderr() {
    ::dup2(before_, STDERR_FILENO);
    for (const int end : {before_, ends_[0], ends_[1]}) ::close(end);
  }
  PipedStderr(const PipedStderr&) = delete;
  PipedStderr& operator=(const PipedStderr&) = delete;

  /// It is empty, and is full then.
  void fill() const {
    const std::string blanks(static_cast<std::size_t>(::fcntl(ends_[1], F_GETPIPE_SZ)), ' ');
    REQUIRE(::write(ends_[1], blanks.data(), blanks.size()) == static_cast<ssize_t>(blanks.size()));
  }
  /// What is in it, without blanks before it.
  [[nodiscard]] std::string read() const {
    std::string text(1 << 20, '\0');
    const auto size = ::read(ends_[0], text.data(), text.size());
    text.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
    return text.substr(std::min(text.find_first_not_of(' '), text.size()));
  }

 private:
  std::array<int, 2> ends_{};
  int before_;
};

}  // namespace ocm::test
