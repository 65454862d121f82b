/// What the code under test writes to one of its streams, while one lives.
#pragma once

#include <cstdio>
#include <optional>
#include <string>
#include <unistd.h>

#include "cli/shared/messages.hpp"

namespace ocm::test {

class Captured {
 public:
  explicit Captured(int descriptor) : descriptor_(descriptor), file_(std::tmpfile()) {
    std::fflush(nullptr);
    kept_ = ::dup(descriptor);
    ::dup2(::fileno(file_), descriptor);
  }
  ~Captured() { static_cast<void>(text()); }
  Captured(const Captured&) = delete;
  Captured& operator=(const Captured&) = delete;
  /// All of it; the stream is as it was from now on.
  std::string text() {
    if (file_ == nullptr) return text_;
    std::fflush(nullptr);
    ::dup2(kept_, descriptor_);
    ::close(kept_);
    std::rewind(file_);
    for (int c = std::fgetc(file_); c != EOF; c = std::fgetc(file_)) text_ += static_cast<char>(c);
    std::fclose(file_);
    file_ = nullptr;
    return text_;
  }

 private:
  int descriptor_, kept_ = -1;
  std::FILE* file_;
  std::string text_;
};

/// What is said as `act` leaves through cli::fail, and with which exit code; none: it does not leave.
struct Leaving {
  std::string text;
  std::optional<int> code;
};
template <class Act>
Leaving leaving(Act&& act) {
  Captured said{STDERR_FILENO};
  try {
    act();
  } catch (const cli::Exit& exit) {
    return {said.text(), exit.code};
  }
  return {said.text(), std::nullopt};
}

}  // namespace ocm::test
