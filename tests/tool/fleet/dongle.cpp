// Of which kind a dongle is, by what it answers and when: it is played on a pseudo terminal.
#include "cli/fleet/dongle.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <fcntl.h>
#include <poll.h>
#include <string>
#include <string_view>
#include <termios.h>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/host/descriptor.hpp"

#include "cli/shared/messages.hpp"
#include "tests/tool/captured.hpp"

namespace fleet_dongle_test {

using namespace std::chrono_literals;
using namespace ocm;
using cli::fleet::open_dongle;
using mapper::server::Dialect;

/// Silent, or says something as soon as it has heard some word, one after the other; the last one each time.
class Device {
 public:
  struct Answer {
    std::string word, text;
  };
  explicit Device(std::vector<Answer> answers = {})
      : answers_(std::move(answers)), primary_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
    REQUIRE(primary_);
    REQUIRE(::grantpt(primary_.get()) == 0);
    REQUIRE(::unlockpt(primary_.get()) == 0);
    path = ::ptsname(primary_.get());
    secondary_ = host::Descriptor{::open(path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC)};
    REQUIRE(secondary_);
    if (!answers_.empty()) talks_ = std::thread{[this] { talk(); }};
  }
  ~Device() {
    over_ = true;
    if (talks_.joinable()) talks_.join();
  }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  /// Of one that is silent: what was written to it, as much as `expected` has; less where no more comes.
  std::string heard(const std::string& expected) {
    for (int looks = 0; looks < 50'000 && heard_.size() < expected.size(); ++looks)
      if (!hear()) ::usleep(100);
    return heard_;
  }
  [[nodiscard]] speed_t speed() const {
    termios settings{};
    ::tcgetattr(secondary_.get(), &settings);
    return ::cfgetospeed(&settings);
  }
  std::string path;

 private:
  void talk() {
    std::size_t heard_before = 0;
    for (std::size_t i = 0; !over_ && !answers_.empty();) {
      const Answer& answer = answers_[std::min(i, answers_.size() - 1)];
      const auto found = heard_.find(answer.word, heard_before);
      if (found == std::string::npos) {
        pollfd line{primary_.get(), POLLIN, 0};
        if (::poll(&line, 1, 10) > 0) static_cast<void>(hear());
        continue;
      }
      heard_before = found + answer.word.size();
      ++i;
      for (std::string_view rest = answer.text; !over_ && !rest.empty();) {
        const ssize_t size = ::write(primary_.get(), rest.data(), rest.size());
        if (size > 0) rest.remove_prefix(static_cast<std::size_t>(size));
      }
    }
  }
  bool hear() {
    std::array<char, 100> room{};
    const ssize_t size = ::read(primary_.get(), room.data(), room.size());
    if (size > 0) heard_.append(room.data(), static_cast<std::size_t>(size));
    return size > 0;
  }

  std::vector<Answer> answers_;
  std::string heard_;
  host::Descriptor primary_, secondary_;
  std::atomic<bool> over_ = false;
  std::thread talks_;
};

TEST_CASE("dongle: it is one of ours where a whole line says how many robots are found") {
  const Device device{{{"stop\n", "found it\nfound 2\n"}}};
  const auto dongle = open_dongle("robots", device.path, {});
  CHECK(dongle.dialect == Dialect::words);
  CHECK(dongle.heard == "found it\nfound 2\n");
  CHECK(dongle.port.path() == device.path);
}

TEST_CASE("dongle: it has 600 ms to answer, and 100 ms to take the end of what it holds") {
  const Device device{{{"AT?.", "OK."}}};
  const auto begin = std::chrono::steady_clock::now();
  const auto dongle = open_dongle("robots", device.path, {});
  CHECK(std::chrono::steady_clock::now() - begin >= 700ms);
  CHECK(dongle.dialect == Dialect::at);
  CHECK(dongle.heard == "OK.");
}

TEST_CASE("dongle: one that says nothing is asked what each kind would answer, and has 600 ms for each") {
  Device device;
  cli::fleet::DongleOptions options;
  options.baud = 38'400;
  const auto begin = std::chrono::steady_clock::now();
  const auto left =
      test::leaving([&] { static_cast<void>(cli::fleet::open_dongle("robots", device.path, options)); });
  // And 100 ms to take the end of what it holds.
  CHECK(std::chrono::steady_clock::now() - begin >= 1900ms);
  CHECK(left.code == cli::exit_failure);
  CHECK_THAT(left.text, Catch::StartsWith("amiroctl: robots: nothing at " + device.path +
                                          " answers as a central does, at 38400 baud\n"));
  const std::string asked = "*\nstop\n.AT?.\nlist\n";
  CHECK(device.heard(asked) == asked);
}

TEST_CASE("dongle: a line that says something else, and one that does not end, are no answer of ours") {
  const std::string no_answer = "found it\nfound 2";
  const Device device{{{"stop\n", no_answer}, {"AT?.", "OK."}}};
  const auto dongle = open_dongle("robots", device.path, {});
  CHECK(dongle.dialect != Dialect::words);
}

TEST_CASE("dongle: one that is known is led out of data mode, and has 100 ms to say so") {
  struct Row {
    const char* kind;
    Dialect dialect;
    const char* heard;
  };
  for (const Row& row : {Row{"ours", Dialect::words, "*\n"}, Row{"thesis", Dialect::thesis, "*\n"},
                         Row{"at", Dialect::at, "*."}}) {
    CAPTURE(row.kind);
    Device device;
    cli::fleet::DongleOptions options;
    options.kind = row.kind;
    const auto begin = std::chrono::steady_clock::now();
    const auto dongle = open_dongle("robots", device.path, options);
    CHECK(std::chrono::steady_clock::now() - begin >= 100ms);
    CHECK(dongle.dialect == row.dialect);
    CHECK(dongle.heard.empty());
    CHECK(device.heard(row.heard) == row.heard);
    CHECK(device.speed() == speed_t{B38400});
  }
}

TEST_CASE("dongle: of two speeds the first at which it is known is taken, or the one that is given") {
  struct Row {
    std::uint32_t baud;
    speed_t speed;
  };
  for (const Row& row : {Row{0, B38400}, Row{115'200, B115200}}) {
    CAPTURE(row.baud);
    const Device device{{{"stop\n", "found 0\n"}}};
    cli::fleet::DongleOptions options;
    options.baud = row.baud;
    const auto dongle = open_dongle("robots", device.path, options);
    CHECK(dongle.dialect == Dialect::words);
    CHECK(device.speed() == row.speed);
  }
}

}  // namespace fleet_dongle_test
