// This machine as the central of robots on serial lines, in time that is handed in; the lines are pseudo
// terminals.
#include "cli/central/switchboard.hpp"

#include <chrono>
#include <cstdlib>
#include <fcntl.h>
#include <memory>
#include <string>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "tests/tool/captured.hpp"

namespace fleet_switchboard_test {

using namespace std::chrono_literals;
using namespace ocm;
using namespace ocm::test;
using cli::central::Switchboard;

/// The robot's end of a line.
class Line {
 public:
  Line() : primary_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK)) {
    REQUIRE(primary_ >= 0);
    REQUIRE(::grantpt(primary_) == 0);
    REQUIRE(::unlockpt(primary_) == 0);
    path = ::ptsname(primary_);
    termios raw{};
    secondary_ = ::open(path.c_str(), O_RDWR | O_NOCTTY);
    ::tcgetattr(secondary_, &raw);
    ::cfmakeraw(&raw);
    ::tcsetattr(secondary_, TCSANOW, &raw);
  }
  ~Line() {
    unplug();
    ::close(secondary_);
  }
  Line(const Line&) = delete;
  Line& operator=(const Line&) = delete;
  /// Returns when it is there: the kernel hands it on in its own time.
  void says(const std::string& text) const {
    const int before = waiting();
    REQUIRE(::write(primary_, text.data(), text.size()) == static_cast<ssize_t>(text.size()));
    while (waiting() < before + static_cast<int>(text.size())) ::usleep(100);
  }
  /// As much as `expected` has; less where no more comes.
  [[nodiscard]] std::string heard(const std::string& expected) const {
    std::string text(expected.size() + 100, '\0');
    std::size_t size = 0;
    for (int looks = 0; looks < 50'000 && (size < expected.size() || looks == 0); ++looks) {
      const ssize_t more = ::read(primary_, text.data() + size, text.size() - size);
      if (more > 0)
        size += static_cast<std::size_t>(more);
      else if (size < expected.size())
        ::usleep(100);
    }
    text.resize(size);
    return text;
  }
  void unplug() {
    if (primary_ >= 0) ::close(primary_);
    primary_ = -1;
  }
  std::string path;

 private:
  [[nodiscard]] int waiting() const {
    int count = 0;
    ::ioctl(secondary_, FIONREAD, &count);
    return count;
  }

  int primary_;
  int secondary_ = -1;
};

struct Bench {
  Line first, second;
  std::unique_ptr<Switchboard> board;
  base::Time now{100s};

  Bench()
      : board(std::make_unique<Switchboard>(
            cli::central::SwitchboardOptions{{{"AVR", first.path}, {"B", second.path}}, {}, 38'400})) {}
  std::string takes() {
    std::string text{board->output()};
    board->taken(text.size());
    return text;
  }
  /// What is said within so long.
  std::string after(base::Duration time, const std::string& typed = {}) {
    now += time;
    if (!typed.empty()) board->feed(typed, now);
    board->work(now);
    return takes();
  }
  /// The robot does not read, until no more finds room: a pseudo terminal takes some thousand bytes, and more
  /// when the kernel has moved those to its other end, which it does when it has time.
  void flood() {
    std::string much;
    for (int i = 0; i < 3000; ++i) much += "{U,90,50}\n";
    for (int looks = 0; looks < 20; ++looks) {
      static_cast<void>(after(1ms, much));
      if (!board->busy()) looks = 0;
      ::usleep(1000);
    }
  }
  std::string summary() {
    Captured err{STDERR_FILENO};
    board->print_summary();
    return err.text();
  }
};

TEST_CASE("switchboard: robots are found, linked, spoken to and heard") {
  Bench bench;
  CHECK(bench.after(0ms) == "");
  CHECK(bench.board->due() == base::never);
  CHECK(bench.after(1ms, "start\n") == "scanning\n");
  CHECK(bench.board->due() == bench.now + 250ms);
  CHECK(bench.after(1ms, "list\n") == "0:020000000000:AVR\n1:020000000001:B\nend of list\n");
  CHECK(bench.after(1ms, "stop\n") == "found 2\n");
  CHECK(bench.board->due() == base::never);
  CHECK_FALSE(bench.board->busy());
  std::vector<pollfd> inputs;
  bench.board->watch(inputs);
  CHECK(inputs.empty());
  CHECK(bench.after(1ms, "conn 0\n") == "connecting 0\nconnected 0\n");
  bench.board->watch(inputs);
  REQUIRE(inputs.size() == 1);
  CHECK(inputs[0].events == POLLIN);
  CHECK(bench.after(1ms, "{S,CON}\n") == "");
  CHECK(bench.first.heard("{S,CON}\n") == "{S,CON}\n");
  CHECK(bench.second.heard("") == "");
  CHECK(bench.after(1ms, "*conn 1\n{S,WHO}\n") == "command\nconnecting 1\nconnected 1\n");
  CHECK(bench.second.heard("{S,WHO}\n") == "{S,WHO}\n");
  // A whole line at once; what has no end waits for its end, for 20 bytes, or for silence.
  bench.second.says("{S,IDL}\n{U,10,2,3,4,5,6,7,8}\n{S,");
  CHECK(bench.after(1ms) == "[1]:B:{S,IDL}\n[1]:B:{U,10,2,3,4,5,6,7,8}[1]:B:\n");
  CHECK(bench.board->due() == bench.now + 20ms);
  CHECK(bench.after(19ms) == "");
  bench.second.says("ID");
  CHECK(bench.after(1ms) == "");
  CHECK(bench.board->due() == bench.now + 20ms);
  CHECK(bench.after(19ms) == "");
  CHECK(bench.after(1ms) == "[1]:B:{S,ID");
  CHECK(bench.board->due() == base::never);
  CHECK(bench.summary() ==
        "AVR     links 1, packets from it 0, to it 1\nB       links 1, packets from it 4, to it 1\nserver  "
        "nothing was lost\n");
}

TEST_CASE("switchboard: what is typed keeps it busy until it is with the robot") {
  Bench bench;
  CHECK(bench.after(1ms, "start\nconn 0\n") == "scanning\nconnecting 0\nconnected 0\n");
  CHECK_FALSE(bench.board->busy());
  const std::string packet = "{U,-180,50}{S,IDL}{S";  // of 20 bytes: it is full
  bench.board->feed(packet.substr(0, 19), bench.now);
  CHECK_FALSE(bench.board->busy());
  bench.board->feed(packet.substr(19), bench.now);
  CHECK(bench.board->busy());
  CHECK(bench.after(0ms) == "");
  CHECK(bench.first.heard(packet) == packet);
  CHECK_FALSE(bench.board->busy());
}

TEST_CASE("switchboard: a packet of which its line takes a part only keeps it busy, with none behind it") {
  Bench bench;
  CHECK(bench.after(1ms, "start\nconn 0\n") == "scanning\nconnecting 0\nconnected 0\n");
  for (int i = 0; i < 100'000 && !bench.board->busy(); ++i)
    static_cast<void>(bench.after(1ms, "{U,90,50}\n"));
  CHECK(bench.board->busy());
  CHECK(bench.summary().ends_with("server  nothing was lost\n"));
}

TEST_CASE("switchboard: a line that is closed sends what it has, for 300 ms at most") {
  Bench bench;
  CHECK(bench.after(1ms, "start\nconn 0\n") == "scanning\nconnecting 0\nconnected 0\n");
  CHECK(bench.after(1ms, "*drop 0\n") == "command\nclosing 0\nclosed 0\n");
  CHECK(bench.after(1ms, "start\nconn 0\n") == "scanning\nconnecting 0\nconnected 0\n");
  bench.flood();
  CHECK(bench.board->busy());
  std::vector<pollfd> inputs;
  bench.board->watch(inputs);
  REQUIRE(inputs.size() == 1);
  CHECK(inputs[0].events == (POLLIN | POLLOUT));
  CHECK(bench.after(1ms, "*drop 0\n") == "command\nclosing 0\n");
  CHECK(bench.board->busy());  // nothing waits any more, but its last words are not sent
  CHECK(bench.board->due() == bench.now + 2ms);
  CHECK(bench.after(299ms) == "");
  CHECK(bench.after(1ms) == "closed 0\n");
  CHECK_FALSE(bench.board->busy());
  const std::string said = bench.summary();
  CAPTURE(said);
  CHECK(said.starts_with("AVR     links 2, packets from it 0, to it "));
  CHECK(said.find(" bytes not sent\n") != std::string::npos);
  CHECK(said.find("bytes for links that were gone or full") != std::string::npos);
}

TEST_CASE("switchboard: what comes later is found, what is unplugged is lost") {
  Bench bench;
  auto late = std::make_unique<Line>();
  const std::string link = fmt::format("/tmp/ocm-switchboard-{}", ::getpid());
  bench.board = std::make_unique<Switchboard>(
      cli::central::SwitchboardOptions{{{"AVR", bench.first.path}, {"late", link}}, {}, 38'400});
  CHECK(bench.after(1ms, "start\nlist\n") == "scanning\n0:020000000000:AVR\nend of list\n");
  REQUIRE(::symlink(late->path.c_str(), link.c_str()) == 0);
  CHECK(bench.after(249ms, "list\n") == "0:020000000000:AVR\nend of list\n");
  CHECK(bench.after(1ms, "list\n") == "0:020000000000:AVR\nend of list\n");
  CHECK(bench.after(0ms, "list\n") == "0:020000000000:AVR\n1:020000000001:late\nend of list\n");
  CHECK(bench.after(1ms, "conn 1\n") == "connecting 1\nconnected 1\n");
  late->says("{U,1");
  CHECK(bench.after(1ms) == "");
  late->unplug();
  Captured err{STDERR_FILENO};
  const std::string lost = bench.after(1ms) + bench.after(1ms);
  CHECK(err.text().starts_with("late: '"));
  CHECK(lost == "[1]:late:{U,1lost 1\n");
  CHECK(bench.after(1ms, "*reset\n") == "command\nreset\n");
  CHECK(bench.board->due() == base::never);
  CHECK(bench.after(1ms, "conn 1\n").starts_with("error: "));
  ::unlink(link.c_str());
}

TEST_CASE("switchboard: what the server does not read is lost by whole packets, and counted") {
  Bench bench;
  static_cast<void>(bench.after(1ms, "start\nconn 0\n"));
  const std::string line = "{S,IDL}\n", shown = "[0]:AVR:{S,IDL}\n";
  std::size_t said = 0;
  for (; said < 3 * Switchboard::max_output / line.size(); said += 100) {
    for (int i = 0; i < 100; ++i) bench.first.says(line);
    bench.now += 1ms;
    bench.board->work(bench.now);
  }
  const std::string output{bench.board->output()};
  CHECK(output.size() <= Switchboard::max_output);
  CHECK(output.size() > Switchboard::max_output - 2 * shown.size() - 10);
  CHECK(output.ends_with(shown));
  const std::size_t kept = (output.size()) / shown.size();
  const std::string first = bench.summary();
  CHECK(first.starts_with(
      fmt::format("AVR     links 1, packets from it {}, to it 0, {} lost: the server did not read\n", said,
                  said - kept)));
  bench.board->discard();
  CHECK(bench.board->output().empty());
  CHECK(bench.summary().ends_with(
      fmt::format("server  {} bytes sent with no server connected\n", output.size())));
  bench.first.says(line);
  CHECK(bench.after(1ms) == shown);
}

TEST_CASE("switchboard: each word that is refused is counted") {
  Bench bench;
  static_cast<void>(bench.after(1ms, "conn 0\nhello\nswitch 0\n"));
  CHECK(bench.summary().ends_with("server  3 commands refused\n"));
}

TEST_CASE("switchboard: a packet is kept where it finds room behind a prefix of any number") {
  for (const std::string line : {"{S,IDL}\n", "{S,A}\n"}) {  // of the second the last one just fits
    CAPTURE(line);
    Bench bench;
    static_cast<void>(bench.after(1ms, "start\nconn 0\n"));
    const std::size_t shown = line.size() + std::string_view{"[0]:AVR:"}.size();
    const std::size_t needed = line.size() + std::string_view{"[255]:AVR:"}.size();
    for (std::size_t said = 0; said < 2 * Switchboard::max_output / shown; said += 100) {
      for (int i = 0; i < 100; ++i) bench.first.says(line);
      bench.now += 1ms;
      bench.board->work(bench.now);
    }
    CHECK(bench.board->output().size() == ((Switchboard::max_output - needed) / shown + 1) * shown);
  }
}

TEST_CASE("switchboard: a line that is unplugged while it is closed is closed once") {
  Bench bench;
  CHECK(bench.after(1ms, "start\nconn 0\n") == "scanning\nconnecting 0\nconnected 0\n");
  bench.flood();
  CHECK(bench.after(1ms, "*drop 0\n") == "command\nclosing 0\n");
  bench.first.unplug();
  std::string closed, said;
  {
    Captured err{STDERR_FILENO};
    closed = bench.after(1ms) + bench.after(1ms);
    said = err.text();
  }
  CHECK(said.starts_with("AVR: '"));
  CHECK(closed == "closed 0\n");
  CHECK(bench.summary().find("stray") == std::string::npos);
}

TEST_CASE("switchboard: a reset ends a search, too") {
  Bench bench;
  CHECK(bench.after(1ms, "start\n") == "scanning\n");
  CHECK(bench.board->due() == bench.now + 250ms);
  CHECK(bench.after(1ms, "reset\n") == "reset\n");
  CHECK(bench.board->due() == base::never);
  CHECK(bench.after(250ms, "list\n") == "end of list\n");
  CHECK(bench.summary().ends_with("server  nothing was lost\n"));  // no robot was found meanwhile
}

}  // namespace fleet_switchboard_test
