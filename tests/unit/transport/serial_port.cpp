#include "ocm/transport/serial_port.hpp"

#include <array>
#include <atomic>
#include <string>
#include <string_view>
#include <thread>

#include <catch2/catch.hpp>

#include "ocm/transport/pty.hpp"

namespace transport_serial_port_test {

using namespace ocm;
using Catch::Contains;
using transport::Pty;
using transport::SerialPort;

std::string all(SerialPort& port) {
  std::string text;
  std::array<char, 64> room{};
  for (auto size = port.read(room); size && *size != 0; size = port.read(room))
    text.append(room.data(), *size);
  return text;
}
std::string all(Pty& pty) {
  std::string text;
  std::array<char, 64> room{};
  while (const std::size_t size = pty.read(room)) text.append(room.data(), size);
  return text;
}
host::Failure failure(const std::string& path, std::uint32_t baud = 115'200) {
  auto port = SerialPort::open(path, baud);
  CHECK_FALSE(port);
  return port.error;
}

TEST_CASE("serial port: bytes as they are, both ways") {
  auto pty = Pty::open();
  REQUIRE(pty);
  auto port = SerialPort::open(pty->path(), 38'400);
  REQUIRE(port);
  CHECK(*port);
  CHECK(port->path() == pty->path());
  std::string every;
  for (int byte = 0; byte < 256; ++byte) every += static_cast<char>(byte);
  CHECK(pty->write(every) == 256);
  CHECK(all(*port) == every);
  CHECK(port->write(every).value == 256);
  CHECK(all(*pty) == every);
  CHECK(all(*port).empty());
}

TEST_CASE("serial port: nothing to read, no room, no bytes asked for: no error") {
  auto pty = Pty::open();
  REQUIRE(pty);
  auto port = SerialPort::open(pty->path());
  REQUIRE(port);
  std::array<char, 8> room{};
  CHECK(port->read(room) == base::Result<std::size_t>{0});
  CHECK(pty->write("x") == 1);
  CHECK(port->read(std::span<char>{}) == base::Result<std::size_t>{0});
  std::size_t taken = 0;
  base::Result<std::size_t> last{1};
  for (int i = 0; i < 10'000 && *last != 0; ++i) {
    last = port->write(std::string(1000, 'y'));
    REQUIRE(last);
    taken += *last;
  }
  CHECK(*last == 0);
  CHECK(all(*pty).size() == taken);
}

TEST_CASE("serial port: a text that the line takes in parts arrives whole") {
  auto pty = Pty::open();
  REQUIRE(pty);
  auto port = SerialPort::open(pty->path());
  REQUIRE(port);
  std::string text;
  for (int i = 0; text.size() < 1'000'000; ++i) text += std::to_string(i) + ' ';
  // Read while it is written: a line that has had no room takes more within one call.
  std::string come;
  std::atomic<bool> ends = false;
  std::thread reader{[&] {
    while (come.size() < text.size() && !ends) come += all(*pty);
  }};
  std::size_t taken = 0;
  while (taken < text.size()) {
    const auto size = port->write(std::string_view{text}.substr(taken));
    if (!size || *size > text.size() - taken) break;
    taken += *size;
  }
  ends = taken != text.size();
  reader.join();
  CHECK(taken == text.size());
  CHECK(come == text);
}

TEST_CASE("serial port: in words, what is wrong and what to do") {
  CHECK_THAT(failure("/dev/no-such-line").what, Contains("there is no serial device '/dev/no-such-line'"));
  CHECK_THAT(failure("/dev/null").what, Contains("'/dev/null' is no serial device"));
  CHECK_THAT(failure("/etc/passwd").what, Contains("'/etc/passwd' is no serial device"));
  CHECK_THAT(failure("/tmp").what, Contains("'/tmp' is no serial device"));
  CHECK_FALSE(failure("/dev/no-such-line").remedy.empty());
  CHECK_THAT(transport::detail::open_failure("/dev/x", EACCES).what,
             Contains("not allowed to open '/dev/x'"));
  CHECK_THAT(transport::detail::open_failure("/dev/x", EACCES).remedy, Contains("dialout"));

  auto pty = Pty::open();
  REQUIRE(pty);
  CHECK(failure(pty->path(), 12'345).what == "a serial line has no speed 12345 here");
  CHECK(failure(pty->path(), 12'345).remedy == "the nearest is 9600");
  auto port = SerialPort::open(pty->path());  // the refused one has let it go
  REQUIRE(port);
  CHECK_THAT(failure(pty->path()).what, Contains("'" + pty->path() + "' is in use by another program"));
  port->close();
  CHECK_FALSE(*port);
  CHECK(SerialPort::open(pty->path()));
}

TEST_CASE("serial port: unplugged, what had come is read first, then it is gone") {
  auto pty = Pty::open();
  REQUIRE(pty);
  auto port = SerialPort::open(pty->path());
  REQUIRE(port);
  CHECK(port->failure().what.empty());
  *pty = Pty{};
  std::array<char, 8> room{};
  CHECK(port->read(room).error == base::Error::closed);
  CHECK_THAT(port->failure().what, Contains("is gone: unplugged"));
  CHECK(port->write("x").error == base::Error::closed);
}

TEST_CASE("serial port: the last words before the end arrive, also where the line is opened again") {
  // As a program ends that leaves a central in command mode, and asks nothing more.
  auto pty = Pty::open();
  REQUIRE(pty);
  std::string arrived;
  for (int round = 0; round < 100; ++round) {
    auto port = SerialPort::open(pty->path());
    REQUIRE(port);
    CHECK(port->write("*").value == 1);
    port->close();
    REQUIRE(SerialPort::open(pty->path()));
    arrived += all(*pty);
  }
  CHECK(arrived == std::string(100, '*'));
}

TEST_CASE("serial port: the line gets its settings back, and its owner may move") {
  auto pty = Pty::open();
  REQUIRE(pty);
  const host::Descriptor other{::open(pty->path().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC)};
  termios echoing{};
  REQUIRE(::tcgetattr(other.get(), &echoing) == 0);
  echoing.c_lflag |= ECHO;
  REQUIRE(::tcsetattr(other.get(), TCSANOW, &echoing) == 0);
  const auto echoes = [&] {
    termios now{};
    REQUIRE(::tcgetattr(other.get(), &now) == 0);
    return (now.c_lflag & ECHO) != 0;
  };
  SerialPort kept;
  {
    auto port = SerialPort::open(pty->path());
    REQUIRE(port);
    CHECK_FALSE(echoes());
    kept = std::move(*port);
  }
  CHECK_FALSE(echoes());
  CHECK(kept.write("x").value == 1);
  kept = SerialPort{};
  CHECK(echoes());
}

TEST_CASE("serial port: speed, flow and bytes as they are, whatever the line was set to") {
  auto pty = Pty::open();
  REQUIRE(pty);
  const host::Descriptor other{::open(pty->path().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC)};
  const auto settings = [&] {
    termios now{};
    REQUIRE(::tcgetattr(other.get(), &now) == 0);
    return now;
  };
  termios odd = settings();
  odd.c_cflag |= CRTSCTS | CSTOPB;
  odd.c_iflag |= IXOFF | IXON | ICRNL;
  odd.c_lflag |= ECHO | ICANON | ISIG;
  odd.c_oflag |= OPOST | ONLCR;
  odd.c_cc[VMIN] = 7;
  odd.c_cc[VTIME] = 3;
  REQUIRE(::tcsetattr(other.get(), TCSANOW, &odd) == 0);
  odd = settings();
  for (const auto& [number, speed] : transport::detail::serial_speeds) {
    // QEMU's user mode knows no speed above 460,800.
    termios fast = odd;
    ::cfsetispeed(&fast, speed);
    ::cfsetospeed(&fast, speed);
    REQUIRE(::tcsetattr(other.get(), TCSANOW, &fast) == 0);
    fast = settings();
    if (number > 460'800 && ::cfgetospeed(&fast) != speed) continue;
    REQUIRE(::tcsetattr(other.get(), TCSANOW, &odd) == 0);
    for (const auto flow : {transport::SerialFlow::none, transport::SerialFlow::rts_cts}) {
      CAPTURE(number);
      const auto port = SerialPort::open(pty->path(), number, flow);
      REQUIRE(port);
      const termios now = settings();
      CHECK(::cfgetispeed(&now) == speed);
      CHECK(::cfgetospeed(&now) == speed);
      CHECK(((now.c_cflag & CRTSCTS) != 0) == (flow == transport::SerialFlow::rts_cts));
      CHECK((now.c_cflag & CSTOPB) == 0);
      CHECK((now.c_cflag & (CLOCAL | CREAD)) == (CLOCAL | CREAD));
      CHECK((now.c_iflag & (IXOFF | IXON | ICRNL)) == 0);
      CHECK((now.c_lflag & (ECHO | ICANON | ISIG)) == 0);
      CHECK((now.c_oflag & OPOST) == 0);
      CHECK(now.c_cc[VMIN] == 1);
      CHECK(now.c_cc[VTIME] == 0);
    }
    const termios back = settings();
    CHECK(back.c_cflag == odd.c_cflag);
    CHECK(back.c_iflag == odd.c_iflag);
    CHECK(back.c_lflag == odd.c_lflag);
    CHECK(back.c_oflag == odd.c_oflag);
    CHECK(back.c_cc[VMIN] == 7);
  }
  // What waits of another program is thrown away.
  CHECK(pty->write("of before") == 9);
  auto port = SerialPort::open(pty->path());
  REQUIRE(port);
  CHECK(all(*port).empty());
}

TEST_CASE("serial port: the speeds that Linux has") {  // asm-generic/termbits.h, from B9600 on
  std::vector<std::uint32_t> speeds;
  for (const auto& entry : transport::detail::serial_speeds) speeds.push_back(entry.first);
  CHECK(speeds == std::vector<std::uint32_t>{9600, 19'200, 38'400, 57'600, 115'200, 230'400, 460'800, 500'000,
                                             576'000, 921'600, 1'000'000, 1'152'000, 1'500'000, 2'000'000,
                                             2'500'000, 3'000'000, 3'500'000, 4'000'000});
}

TEST_CASE("serial port: the nearest speed that there is") {
  using transport::detail::nearest_serial_speed;
  for (const auto& entry : transport::detail::serial_speeds) {
    CHECK(nearest_serial_speed(entry.first) == entry.first);
    CHECK(nearest_serial_speed(entry.first - 1) == entry.first);
    CHECK(nearest_serial_speed(entry.first + 1) == entry.first);
  }
  CHECK(nearest_serial_speed(0) == 9600);
  CHECK(nearest_serial_speed(14'399) == 9600);
  CHECK(nearest_serial_speed(14'401) == 19'200);
  CHECK(nearest_serial_speed(UINT32_MAX) == 4'000'000);
}

TEST_CASE("serial port: every cause has its words") {
  using namespace transport::detail;
  const auto why = [](int error) { return std::string(" (") + std::strerror(error) + ")"; };
  for (const int error : {ENOENT, ENXIO, ENODEV}) {
    CHECK(open_failure("/dev/x", error).what == "there is no serial device '/dev/x'" + why(error));
    CHECK_FALSE(open_failure("/dev/x", error).remedy.empty());
  }
  for (const int error : {EACCES, EPERM}) {
    CHECK(open_failure("/dev/x", error).what == "not allowed to open '/dev/x'" + why(error));
    CHECK_THAT(open_failure("/dev/x", error).remedy, Contains("(see ls -l /dev/x)"));
  }
  for (const int error : {EBUSY, EWOULDBLOCK}) {
    CHECK(open_failure("/dev/x", error).what == "'/dev/x' is in use by another program");
    CHECK(open_failure("/dev/x", error).remedy == "end that one: `fuser -v /dev/x` names it");
  }
  CHECK(open_failure("/run/x", ECONNREFUSED).what ==
        "no program listens on the socket '/run/x'" + why(ECONNREFUSED));
  CHECK(open_failure("/dev/x", EIO).what == "cannot open '/dev/x'" + why(EIO));
  CHECK(no_serial_device("/dev/x").what == "'/dev/x' is no serial device");
  CHECK(no_serial_device("/dev/x", "a socket").what == "'/dev/x' is neither a serial device nor a socket");
  CHECK(line_gone("it", 0).what == "it is gone: unplugged, or its other end closed");
  CHECK(line_gone("it", EIO).what == line_gone("it", 0).what);
  CHECK(line_gone("it", ENXIO).what == line_gone("it", 0).what + why(ENXIO));
}

TEST_CASE("serial port: what has moved away is no port, and what it knew goes with it") {
  auto pty = Pty::open();
  REQUIRE(pty);
  auto port = SerialPort::open(pty->path());
  REQUIRE(port);
  SerialPort moved{std::move(*port)};
  CHECK(moved.path() == pty->path());
  CHECK(moved);
  CHECK_FALSE(*port);  // NOLINT: that is what is asked
  std::array<char, 8> room{};
  *pty = Pty{};
  CHECK_FALSE(moved.read(room));
  const std::string what = moved.failure().what;
  CHECK_FALSE(what.empty());
  SerialPort assigned;
  CHECK_FALSE(assigned);
  assigned = std::move(moved);
  CHECK(assigned.failure().what == what);
  CHECK(SerialPort{std::move(assigned)}.failure().what == what);
}

TEST_CASE(
    "serial port: a pseudo terminal is locked, but not exclusive: that would outlive a killed program") {
  auto pty = Pty::open();
  REQUIRE(pty);
  const auto port = SerialPort::open(pty->path());
  REQUIRE(port);
  // QEMU's user mode does not know TIOCGEXCL: on the operator's board it is only told.
  int exclusive = 0;
  if (::ioctl(port->descriptor(), TIOCGEXCL, &exclusive) != 0) WARN("no TIOCGEXCL: not asked");
  CHECK(exclusive == 0);
}

}  // namespace transport_serial_port_test
