// A central's line that goes while this program has it, and one that this program leaves.
#include "cli/fleet/own_line.hpp"

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <fcntl.h>
#include <string>
#include <string_view>
#include <sys/ioctl.h>
#include <termios.h>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "ocm/host/descriptor.hpp"

#include "cli/fleet/line_time.hpp"
#include "cli/shared/messages.hpp"
#include "tests/tool/captured.hpp"

namespace fleet_own_line_test {

using namespace std::chrono_literals;
using namespace ocm;
using namespace ocm::test;

/// That says nothing.
host::Descriptor silent_dongle() {
  host::Descriptor dongle{::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)};
  REQUIRE(dongle);
  REQUIRE(::grantpt(dongle.get()) == 0);
  REQUIRE(::unlockpt(dongle.get()) == 0);
  return dongle;
}

TEST_CASE("own line: where nothing comes it looks after the other programs, each 50 ms") {
  host::Descriptor dongle = silent_dongle();
  auto port = transport::SerialPort::open(::ptsname(dongle.get()));
  REQUIRE(port);
  std::chrono::steady_clock::duration took{};
  static_cast<void>(leaving([&] {
    cli::fleet::OwnLine line{
        "robots", cli::fleet::Dongle{std::move(*port), mapper::server::Dialect::words, {}}, {}, nullptr};
    const auto begin = std::chrono::steady_clock::now();
    line.exchange();
    took = std::chrono::steady_clock::now() - begin;
    dongle.reset();  // or its last answer is waited for
  }));
  CHECK(took >= 50ms);
  CHECK(took < 20s);  // on a busy machine, too
}

TEST_CASE("own line: a line that is gone is said once, whether it is noticed by writing or by reading") {
  for (const bool writes : {true, false}) {
    CAPTURE(writes);
    host::Descriptor dongle = silent_dongle();
    const std::string path = ::ptsname(dongle.get());
    auto port = transport::SerialPort::open(path);
    REQUIRE(port);
    const Leaving left = leaving([&] {
      cli::fleet::OwnLine line{
          "robots", cli::fleet::Dongle{std::move(*port), mapper::server::Dialect::words, {}}, {}, nullptr};
      if (writes) line.scan(0s);  // which is to be said
      dongle.reset();
      line.exchange();
    });
    CHECK(left.code == cli::exit_failure);
    CHECK(left.text ==
          fmt::format(
              "amiroctl: robots: '{}' is gone: unplugged, or its other end closed\n          plug it in "
              "again and restart\n",
              path));
  }
}

TEST_CASE(
    "own line: a robot is this program's from its set point or its turn on; to ask for its compass is no "
    "order") {
  host::Descriptor dongle = silent_dongle();
  auto port = transport::SerialPort::open(::ptsname(dongle.get()));
  REQUIRE(port);
  static_cast<void>(leaving([&] {
    cli::fleet::OwnLine line{
        "robots", cli::fleet::Dongle{std::move(*port), mapper::server::Dialect::words, {}}, {}, nullptr};
    CHECK_FALSE(line.go(3, {90, 50}));
    CHECK(line.robot(3).order == 1);
    CHECK(line.is_ours(3));
    CHECK_FALSE(line.calibrate(4, false));
    CHECK(line.robot(4).order == 2);
    CHECK(line.is_ours(4));
    CHECK_FALSE(line.calibrate(4, true));
    CHECK(line.robot(4).order == 2);
    CHECK(line.is_ours(4));
    CHECK_FALSE(line.owner().go(3, {0, 10}, cli::fleet::line_time()));  // not said by the line
    CHECK_FALSE(line.is_ours(3));
    CHECK(line.is_charge(3));
    dongle.reset();  // or its last answer is waited for
  }));
}

TEST_CASE(
    "own line: what its dongle has said before is heard, and who listens is called no more while it is "
    "left") {
  using mapper::link::Kind;
  const host::Descriptor dongle = silent_dongle();
  auto port = transport::SerialPort::open(::ptsname(dongle.get()));
  REQUIRE(port);
  const std::string idle = "[3]:A:{S,IDL}\n";
  std::vector<std::pair<std::size_t, Kind>> heard;
  {
    cli::fleet::OwnLine line{
        "robots", cli::fleet::Dongle{std::move(*port), mapper::server::Dialect::words, idle}, {}, nullptr};
    line.on_heard([&heard](std::size_t robot, Kind kind) { heard.emplace_back(robot, kind); });
    line.exchange();
    CHECK(line.robot(3).linked);
    // It is left as soon as that is answered, behind a robot's word.
    const std::string last = idle + "\nfound 0\n";
    REQUIRE(::write(dongle.get(), last.data(), last.size()) == static_cast<ssize_t>(last.size()));
  }
  REQUIRE(heard.size() == 1);
  CHECK(heard[0].first == 3);
  CHECK(heard[0].second == Kind::idle);
}

/// A central that has much to pass on before it obeys: behind `stop` so many pieces of one byte, each once
/// the last one was read.
class Talkative {
 public:
  static constexpr int pieces = 60;

  Talkative() : primary_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
    REQUIRE(primary_);
    REQUIRE(::grantpt(primary_.get()) == 0);
    REQUIRE(::unlockpt(primary_.get()) == 0);
    path = ::ptsname(primary_.get());
    secondary_ = host::Descriptor{::open(path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC)};
    REQUIRE(secondary_);
    termios raw{};
    ::tcgetattr(secondary_.get(), &raw);
    ::cfmakeraw(&raw);
    ::tcsetattr(secondary_.get(), TCSANOW, &raw);
    talks_ = std::thread{[this] { talk(); }};
  }
  ~Talkative() { static_cast<void>(read_by_then()); }
  Talkative(const Talkative&) = delete;
  Talkative& operator=(const Talkative&) = delete;
  /// The program has left: how many pieces it has read.
  int read_by_then() {
    over_ = true;
    if (talks_.joinable()) talks_.join();
    return read_;
  }
  std::string path;

 private:
  void talk() {
    while (!over_ && heard_.find("stop\n") == std::string::npos) {
      std::array<char, 100> room{};
      const ssize_t size = ::read(primary_.get(), room.data(), room.size());
      if (size > 0)
        heard_.append(room.data(), static_cast<std::size_t>(size));
      else
        ::usleep(100);
    }
    while (!over_ && read_ < pieces && says("x")) ++read_;
    if (!over_) static_cast<void>(says("\nfound 0\n"));
  }
  /// Until it is read. The kernel hands it on in its own time.
  bool says(std::string_view text) {
    if (::write(primary_.get(), text.data(), text.size()) != static_cast<ssize_t>(text.size())) return false;
    for (int looks = 0; looks < 20 && waiting() == 0; ++looks) ::usleep(100);
    while (!over_ && waiting() != 0) ::usleep(100);
    return waiting() == 0;
  }
  [[nodiscard]] int waiting() const {
    int count = 0;
    ::ioctl(secondary_.get(), FIONREAD, &count);
    return count;
  }

  host::Descriptor primary_, secondary_;
  std::atomic<bool> over_ = false;
  int read_ = 0;
  std::string heard_;
  std::thread talks_;
};

TEST_CASE("own line: it is left in command mode, for which a second is waited, whatever comes meanwhile") {
  Talkative central;
  auto port = transport::SerialPort::open(central.path);
  REQUIRE(port);
  std::chrono::steady_clock::time_point begin;
  {
    const cli::fleet::OwnLine line{
        "robots", cli::fleet::Dongle{std::move(*port), mapper::server::Dialect::words, {}}, {}, nullptr};
    begin = std::chrono::steady_clock::now();
  }
  const auto took = std::chrono::steady_clock::now() - begin;
  const int pieces = central.read_by_then();
  CAPTURE(pieces, took.count());
  CHECK((pieces == Talkative::pieces || took >= 1s));
}

}  // namespace fleet_own_line_test
