#include "cli/serve/address.hpp"

#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <poll.h>
#include <string>
#include <sys/stat.h>
#include <sys/wait.h>
#include <system_error>
#include <thread>
#include <unistd.h>

#include <catch2/catch.hpp>

#include "ocm/host/descriptor.hpp"

#include "tool/captured.hpp"
#include "unit/host/host_testing.hpp"

namespace serve_address_test {

using ocm::cli::serve::open_in_browser;
using ocm::cli::serve::page_address;
using ocm::test::Captured;
using ocm::test::Environment;

TEST_CASE("address: token and what is shown are behind the #") {
  CHECK(page_address("http://127.0.0.1:8484/", "", "") == "http://127.0.0.1:8484/");
  CHECK(page_address("http://h/", "0f", "") == "http://h/#0f");
  CHECK(page_address("http://h/", "", "map") == "http://h/#map");
  CHECK(page_address("http://h/", "0f", "plot=/gyro.z") == "http://h/#0f&plot=/gyro.z");
}

/// A folder with an xdg-open that says through a pipe what it gets: its arguments, and its streams.
class Browser {
 public:
  Browser() {
    const std::string said = folder_.file("said"), program = folder_.file("xdg-open");
    REQUIRE(::mkfifo(said.c_str(), 0600) == 0);
    said_ = ocm::host::Descriptor{::open(said.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)};
    REQUIRE(said_.get() >= 0);
    std::ofstream{program}
        << "#!/bin/sh\nexec 3>" << said << "\necho \"$# $*\" >&3\n"
        << "for stream in 0 1 2; do its=$(readlink /proc/$$/fd/$stream); echo \"$its\" >&3; done\n";
    REQUIRE(::chmod(program.c_str(), 0700) == 0);
  }
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  [[nodiscard]] const std::string& folder() const { return folder_.path(); }
  /// All that it says to its end; what comes within 20 s.
  [[nodiscard]] std::string says() const {
    std::string text;
    pollfd waits{said_.get(), POLLIN, 0};
    while (::poll(&waits, 1, 20'000) == 1) {
      char piece[256];
      const ssize_t size = ::read(said_.get(), piece, sizeof piece);
      if (size <= 0) break;
      text.append(piece, static_cast<std::size_t>(size));
    }
    return text;
  }

 private:
  ocm::test::TemporaryDirectory folder_;
  ocm::host::Descriptor said_;
};

TEST_CASE("address: a browser gets it as it is, and none of this program's streams") {
  for (const char* const display : {"DISPLAY", "WAYLAND_DISPLAY"}) {
    INFO(display);
    const Browser browser;
    const Environment no_x{"DISPLAY", ""}, no_wayland{"WAYLAND_DISPLAY", ""};
    const Environment shown{display, ":7"};
    const Environment path{"PATH", (browser.folder() + ":/usr/bin:/bin").c_str()};
    Captured errors{STDERR_FILENO};
    open_in_browser("http://h/#0f&plot=/gyro.z");
    CHECK(errors.text().empty());
    CHECK(browser.says() == "1 http://h/#0f&plot=/gyro.z\n/dev/null\n/dev/null\n/dev/null\n");
  }
}

TEST_CASE("address: of a browser that has ended no process is left") {
  const Browser browser;
  const Environment display{"DISPLAY", ":7"};
  const Environment path{"PATH", (browser.folder() + ":/usr/bin:/bin").c_str()};
  open_in_browser("http://h/");
  CHECK(browser.says().starts_with("1 http://h/\n"));  // and it ends
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds{20};
  siginfo_t child{};
  while (::waitid(P_ALL, 0, &child, WEXITED | WNOHANG | WNOWAIT) == 0 &&
         std::chrono::steady_clock::now() < end)
    std::this_thread::yield();
  CHECK(::waitid(P_ALL, 0, &child, WEXITED | WNOHANG | WNOWAIT) == -1);
}

TEST_CASE("address: why no browser opens it") {
  const Browser browser;
  const Environment no_x{"DISPLAY", ""}, no_wayland{"WAYLAND_DISPLAY", ""};
  {
    const Environment path{"PATH", browser.folder().c_str()};
    Captured errors{STDERR_FILENO};
    open_in_browser("http://h/");
    CHECK(errors.text() == "serve: there is no display: open the address in a browser elsewhere\n");
  }
  const Environment display{"DISPLAY", ":7"};
  const Environment path{"PATH", "/nonexistent"};
  Captured errors{STDERR_FILENO};
  open_in_browser("http://h/");
  CHECK(errors.text() ==
        "serve: xdg-open cannot be started: No such file or directory; open the address by hand\n");
}

}  // namespace serve_address_test
