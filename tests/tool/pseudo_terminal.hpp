/// A terminal of its own for code under test; a test has the keys.
#pragma once

#include <array>
#include <cstddef>
#include <cstdlib>
#include <fcntl.h>
#include <poll.h>
#include <string>
#include <string_view>
#include <sys/types.h>
#include <unistd.h>

#include <catch2/catch.hpp>

#include "ocm/host/descriptor.hpp"

namespace ocm::test {

class PseudoTerminal {
 public:
  PseudoTerminal() : keys_(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
    REQUIRE(keys_);
    REQUIRE(::grantpt(keys_.get()) == 0);
    REQUIRE(::unlockpt(keys_.get()) == 0);
    const char* const name = ::ptsname(keys_.get());
    REQUIRE(name != nullptr);
    terminal_ = host::Descriptor{::open(name, O_RDWR | O_NOCTTY | O_CLOEXEC)};
    REQUIRE(terminal_);
  }

  /// What a program would have as its standard streams.
  [[nodiscard]] int descriptor() const noexcept { return terminal_.get(); }
  /// Returns when they can be read, where they are read one by one.
  void press(std::string_view keys) const {
    REQUIRE(::write(keys_.get(), keys.data(), keys.size()) == static_cast<ssize_t>(keys.size()));
    pollfd input{terminal_.get(), POLLIN, 0};
    REQUIRE(::poll(&input, 1, 30'000) == 1);
  }
  /// What was written to it since, up to these words.
  [[nodiscard]] std::string shown(std::string_view end) const {
    std::string text;
    while (!text.ends_with(end)) {
      pollfd output{keys_.get(), POLLIN, 0};
      REQUIRE(::poll(&output, 1, 30'000) == 1);
      std::array<char, 4096> some{};
      const auto size = ::read(keys_.get(), some.data(), some.size());
      REQUIRE(size > 0);
      text.append(some.data(), static_cast<std::size_t>(size));
    }
    return text;
  }
  /// As a window that is closed.
  void close() noexcept { keys_.reset(); }

 private:
  host::Descriptor keys_;
  host::Descriptor terminal_;
};

}  // namespace ocm::test
