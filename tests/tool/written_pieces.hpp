/// In which pieces something is written.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <sys/socket.h>
#include <sys/types.h>
#include <unistd.h>
#include <vector>

#include <catch2/catch.hpp>

namespace ocm::test {

/// A descriptor to write to, which keeps apart what each write brings.
class WrittenPieces {
 public:
  WrittenPieces() { REQUIRE(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends_.data()) == 0); }
  ~WrittenPieces() {
    for (const int end : ends_) ::close(end);
  }
  WrittenPieces(const WrittenPieces&) = delete;
  WrittenPieces& operator=(const WrittenPieces&) = delete;

  [[nodiscard]] int descriptor() const noexcept { return ends_[0]; }
  /// How long each is that came since it was asked last; one of more than `longest` bytes is cut.
  [[nodiscard]] std::vector<std::size_t> sizes(std::size_t longest) const {
    std::vector<std::size_t> found;
    std::string piece(longest, '\0');
    for (;;) {
      const ssize_t size = ::recv(ends_[1], piece.data(), piece.size(), MSG_DONTWAIT);
      if (size <= 0) return found;
      found.push_back(static_cast<std::size_t>(size));
    }
  }

 private:
  std::array<int, 2> ends_{};
};

}  // namespace ocm::test
