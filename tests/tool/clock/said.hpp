/// What the code under test says on stderr.
#pragma once

#include <array>
#include <cstdio>
#include <memory>
#include <string>
#include <unistd.h>

#include <catch2/catch.hpp>

namespace ocm::test {

/// Keeps all that is said while one lives.
class Said {
 public:
  Said() : file_(std::tmpfile()), stderr_(::dup(STDERR_FILENO)) {
    REQUIRE(file_ != nullptr);
    std::fflush(stderr);
    REQUIRE(::dup2(::fileno(file_.get()), STDERR_FILENO) == STDERR_FILENO);
  }
  ~Said() {
    std::fflush(stderr);
    ::dup2(stderr_, STDERR_FILENO);
    ::close(stderr_);
  }
  Said(const Said&) = delete;
  Said& operator=(const Said&) = delete;

  /// All since this was asked last.
  [[nodiscard]] std::string text() {
    std::fflush(stderr);
    std::string all;
    std::array<char, 4096> block{};
    for (ssize_t size = 0; (size = ::pread(::fileno(file_.get()), block.data(), block.size(), read_)) > 0;) {
      all.append(block.data(), static_cast<std::size_t>(size));
      read_ += size;
    }
    return all;
  }

 private:
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Closer> file_;
  int stderr_;
  off_t read_ = 0;
};

}  // namespace ocm::test
