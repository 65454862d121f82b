// SerialPort and Pty on lines that are played: what a real serial device is asked for, and what is made of a
// kernel that has no room, no such setting or no pseudo terminal left.
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <linux/tty.h>
#include <string>
#include <sys/sysmacros.h>
#include <utility>

#include <catch2/catch.hpp>

#include "ocm/transport/pty.hpp"
#include "ocm/transport/serial_port.hpp"

#include "unit/host/host_testing.hpp"
#include "unit/transport/played_line.hpp"

namespace transport_serial_port_line_test {

using namespace ocm;
using host::Failure;
using test::PlayedLine;
using transport::Pty;
using transport::SerialPort;
using Requests = std::vector<unsigned long>;

Failure failure(std::uint32_t baud = 115'200) {
  const auto port = SerialPort::open("/dev/null", baud);
  CHECK_FALSE(port);
  return port.error;
}
SerialPort open(std::uint32_t baud = 115'200) {
  auto port = SerialPort::open("/dev/null", baud);
  INFO(port.error.what);
  REQUIRE(port);
  return std::move(*port);
}

// --- a serial device ---

TEST_CASE("serial line: a device is exclusive while it is open, and no longer") {
  PlayedLine line;
  {
    const SerialPort port = open();
    CHECK(line.requests == Requests{TIOCGETD, TIOCEXCL});
  }
  CHECK(line.requests == Requests{TIOCGETD, TIOCEXCL, TIOCNXCL});
}

TEST_CASE("serial line: what was in the line before is thrown away, at the end only what was not sent") {
  PlayedLine line;
  {
    const SerialPort port = open();
    CHECK(line.flushed == std::vector<int>{TCIOFLUSH});
  }
  CHECK(line.flushed == std::vector<int>{TCIOFLUSH, TCOFLUSH});
}

TEST_CASE("serial line: a port that was closed is closed once") {
  PlayedLine line;
  SerialPort port = open();
  port.close();
  port.close();
  CHECK(line.flushed == std::vector<int>{TCIOFLUSH, TCOFLUSH});
  CHECK_FALSE(port);
}

TEST_CASE("serial line: a port that is given another closes its own first") {
  PlayedLine line;
  SerialPort port = open();
  const int first = line.file;
  line.settings.c_lflag = ECHO;
  SerialPort other = open();
  const int second = line.file;
  CHECK(first != second);
  port = std::move(other);
  CHECK(line.flushed == std::vector<int>{TCIOFLUSH, TCIOFLUSH, TCOFLUSH});
  CHECK(port.descriptor() == second);
}

TEST_CASE("serial line: a port that is given itself stays as it is") {
  PlayedLine line;
  SerialPort port = open();
  SerialPort& same = port;
  port = std::move(same);
  CHECK(port);
  CHECK(line.flushed == std::vector<int>{TCIOFLUSH});
}

TEST_CASE("serial line: a device that cannot be asked for its settings is no serial device") {
  PlayedLine line;
  line.settings_error = ENOTTY;
  CHECK(failure() == transport::detail::no_serial_device("/dev/null"));
  CHECK(line.requests.empty());
}

TEST_CASE("serial line: a device that cannot be opened says why") {
  PlayedLine line;
  line.open_error = EACCES;
  CHECK(failure() == transport::detail::open_failure("/dev/null", EACCES));
}

TEST_CASE("serial line: a device that the kernel's slcan driver has is taken") {
  PlayedLine line;
  line.discipline = N_SLCAN;
  CHECK(failure() == Failure{"'/dev/null' is taken by the kernel's slcan driver",
                             "use the interface that it has made (`ip link show type can`), or end slcand"});
}

TEST_CASE("serial line: a device of another line discipline, or of none that it says, is opened") {
  PlayedLine line;
  line.discipline = GENERATE(N_SLCAN + 1, -1);
  CHECK(open());
}

TEST_CASE("serial line: a device that is locked is in use, and gets no settings") {
  PlayedLine line;
  line.settings.c_lflag = ECHO;
  line.lock_error = EWOULDBLOCK;
  CHECK(failure().what == "'/dev/null' is in use by another program");
  CHECK(line.settings.c_lflag == ECHO);
  CHECK(line.requests == Requests{TIOCGETD});
  CHECK(line.flushed.empty());
}

TEST_CASE("serial line: a device that cannot be locked at all is opened") {
  PlayedLine line;
  line.lock_error = ENOLCK;
  CHECK(open());
}

TEST_CASE("serial line: a speed that the device does not have is named") {
  PlayedLine line;
  line.set_error = EINVAL;
  CHECK(failure(57'600) ==
        Failure{std::string("cannot set '/dev/null' to 57600 baud: ") + std::strerror(EINVAL),
                "try another speed, such as 115200"});
}

TEST_CASE("serial line: a speed that no line has leaves the device as it was") {
  PlayedLine line;
  line.settings.c_lflag = ECHO;
  CHECK(failure(12'345) == Failure{"a serial line has no speed 12345 here", "the nearest is 9600"});
  CHECK(line.settings.c_lflag == ECHO);
}

TEST_CASE("serial line: what the kernel has not sent is counted, and is none where it does not say") {
  PlayedLine line;
  const SerialPort port = open();
  line.unsent = 17;
  CHECK(port.unsent() == 17);
  line.unsent = 1;
  CHECK(port.unsent() == 1);
  line.unsent = 0;
  CHECK(port.unsent() == 0);
  line.unsent = -5;
  CHECK(port.unsent() == 0);
}

TEST_CASE("serial line: a signal while it reads or writes changes nothing") {
  PlayedLine line;
  SerialPort port = open();
  line.say("ab");
  line.read_errors = {EINTR, EINTR};
  std::array<char, 8> room{};
  CHECK(port.read(room).value == 2);
  CHECK(room[1] == 'b');
  line.send_errors = {EINTR, EINTR};
  CHECK(port.write("cd").value == 2);
  CHECK(line.heard == "cd");
}

TEST_CASE("serial line: one byte is one byte") {
  PlayedLine line;
  SerialPort port = open();
  line.say("ab");
  std::array<char, 1> room{};
  CHECK(port.read(room).value == 1);
  CHECK(room[0] == 'a');
  line.room = 1;
  CHECK(port.write("cd").value == 1);
  CHECK(line.heard == "c");
  CHECK(port.write("d").value == 0);
}

TEST_CASE("serial line: a device that goes says so with its error, while it reads and while it writes") {
  PlayedLine line;
  SerialPort port = open();
  std::array<char, 8> room{};
  SECTION("its end while it reads") {
    line.hung_up = true;
    CHECK(port.read(room).error == base::Error::closed);
    CHECK(port.failure() ==
          Failure{"'/dev/null' is gone: unplugged, or its other end closed", "plug it in again and restart"});
  }
  SECTION("an error while it reads") {
    line.read_errors = {ENXIO};
    CHECK(port.read(room).error == base::Error::closed);
    CHECK(port.failure().what == std::string("'/dev/null' is gone: unplugged, or its other end closed (") +
                                     std::strerror(ENXIO) + ")");
  }
  SECTION("an error while it writes") {
    line.send_errors = {EIO};
    CHECK(port.write("x").error == base::Error::closed);
    CHECK(port.failure().what == "'/dev/null' is gone: unplugged, or its other end closed");
  }
}

TEST_CASE("serial line: the end of a line is none of the errors of before") {
  PlayedLine line;
  line.stale_error = GENERATE(EAGAIN, EINTR, EIO, ENXIO);
  SerialPort port = open();
  line.hung_up = true;
  std::array<char, 8> room{};
  CHECK(port.read(room).error == base::Error::closed);
  CHECK(port.failure().what == "'/dev/null' is gone: unplugged, or its other end closed");
}

TEST_CASE("serial line: a text that the line has room for is written with one call") {
  PlayedLine line;
  SerialPort port = open();
  CHECK(port.write("abc").value == 3);
  CHECK(line.writes == 1);
  CHECK(port.write("").value == 0);
  CHECK(line.writes == 1);
}

TEST_CASE("serial line: the devices of numbers 136 to 143 are pseudo terminals, which are not exclusive") {
  PlayedLine line;
  const auto [number, exclusive] =
      GENERATE(std::pair{4U, true}, std::pair{135U, true}, std::pair{136U, false}, std::pair{143U, false},
               std::pair{144U, true}, std::pair{188U, true});
  line.number = ::gnu_dev_makedev(number, 2);
  const SerialPort port = open();
  CHECK((line.requests == Requests{TIOCGETD, TIOCEXCL}) == exclusive);
}

// --- which devices there are ---

/// A folder in the place of /dev and one in that of /dev/serial/by-id.
struct Devices {
  Devices() {
    std::filesystem::create_directory(all());
    kernel.openat = [this](const char* path) {
      const std::string asked = path;
      std::string opened = asked;
      if (asked == "/dev/serial/by-id") opened = named();
      if (asked == "/dev") opened = all();
      redirected = redirected || opened != asked;
      return static_cast<int>(
          ::syscall(SYS_openat, AT_FDCWD, opened.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC, 0));
    };
  }
  [[nodiscard]] std::string all() const { return folder.path() + "/dev"; }
  [[nodiscard]] std::string named() const { return folder.path() + "/by-id"; }
  void make(const std::string& path) const { std::ofstream{path} << ""; }
  [[nodiscard]] std::string found() {
    std::string devices = transport::detail::serial_devices();
    // A C++ library that opens folders in another way is not played: on the operator's board.
    if (!redirected) WARN("folders are not played");
    return devices;
  }
  bool redirected = false;
  test::TemporaryDirectory folder;
  test::PlayedKernel kernel;
};

TEST_CASE("serial line: the devices are named by the names that stay, in their order") {
  Devices devices;
  std::filesystem::create_directory(devices.named());
  devices.make(devices.named() + "/usb-b");
  devices.make(devices.named() + "/usb-a");
  devices.make(devices.all() + "/ttyUSB0");
  const std::string found = devices.found();
  if (!devices.redirected) return;
  CHECK(found == "/dev/serial/by-id/usb-a, /dev/serial/by-id/usb-b");
  CHECK(transport::detail::open_failure("/dev/x", ENOENT).remedy ==
        "the serial devices here are: /dev/serial/by-id/usb-a, /dev/serial/by-id/usb-b");
  CHECK(transport::detail::no_serial_device("/dev/x").remedy ==
        "the serial devices here are: /dev/serial/by-id/usb-a, /dev/serial/by-id/usb-b");
}

TEST_CASE("serial line: without names that stay the devices are those of adapters") {
  Devices devices;
  for (const char* name : {"/ttyUSB0", "/ttyACM1", "/tty0", "/ttyS0", "/null", "/xttyACM0"})
    devices.make(devices.all() + name);
  const std::string found = devices.found();
  if (!devices.redirected) return;
  CHECK(found == "/dev/ttyACM1, /dev/ttyUSB0");
}

TEST_CASE("serial line: without devices the remedy is to plug one in") {
  Devices devices;
  const std::string found = devices.found();
  if (!devices.redirected) return;
  CHECK(found.empty());
  CHECK(transport::detail::open_failure("/dev/x", ENODEV).remedy ==
        "plug the adapter in; `dmesg | tail` tells its name, mostly /dev/ttyACM0");
  CHECK(transport::detail::no_serial_device("/dev/x").remedy ==
        "name the adapter's, mostly /dev/ttyACM0 or /dev/ttyUSB0");
}

// --- a pseudo terminal ---

/// A real one, of which single calls are played.
struct Terminal {
  Terminal() {
    REQUIRE(pty);
    kernel.files = {pty->descriptor()};
  }
  host::Outcome<Pty> pty = Pty::open();
  test::PlayedKernel kernel;
};

TEST_CASE("pty line: a machine that has no pseudo terminal left says where to look") {
  test::PlayedKernel kernel;
  kernel.posix_openpt = [] { return test::failed(ENOSPC); };
  CHECK(Pty::open().error ==
        Failure{std::string("cannot make a pseudo terminal: ") + std::strerror(ENOSPC),
                "is /dev/pts mounted, and are there any left? See /proc/sys/kernel/pty/max"});
}

TEST_CASE("pty line: what is no pseudo terminal is not taken for one") {
  test::PlayedKernel kernel;
  kernel.posix_openpt = [] {
    return static_cast<int>(::syscall(SYS_openat, AT_FDCWD, "/dev/null", O_RDWR | O_CLOEXEC, 0));
  };
  CHECK_THAT(Pty::open().error.what, Catch::StartsWith("cannot make a pseudo terminal"));
}

TEST_CASE("pty line: a line that cannot be asked is taken to be attached") {
  Terminal terminal;
  terminal.kernel.ready = [](short) { return short{0}; };
  terminal.kernel.interrupt();
  CHECK(terminal.pty->attached());
}

TEST_CASE("pty line: it is asked for input, and does not wait") {
  Terminal terminal;
  terminal.kernel.ready = [](short) { return static_cast<short>(POLLHUP); };
  CHECK_FALSE(terminal.pty->attached());
  CHECK(terminal.kernel.waits == std::vector<test::PlayedKernel::Wait>{{POLLIN, base::Duration::zero()}});
  terminal.kernel.ready = [](short) { return static_cast<short>(POLLHUP | POLLIN); };
  CHECK(terminal.pty->attached());
  terminal.kernel.ready = [](short) { return static_cast<short>(POLLIN); };
  CHECK(terminal.pty->attached());
}

TEST_CASE("pty line: a signal while it reads or writes changes nothing") {
  Terminal terminal;
  int signals = 2;
  std::string come = "ab";
  terminal.kernel.read = [&](int, void* bytes, std::size_t) -> ssize_t {
    if (signals-- > 0) return test::failed(EINTR);
    std::memcpy(bytes, come.data(), come.size());
    return static_cast<ssize_t>(come.size());
  };
  std::array<char, 8> room{};
  CHECK(terminal.pty->read(room) == 2);
  signals = 2;
  std::string taken;
  terminal.kernel.ready = [](short) { return short{0}; };
  terminal.kernel.write = [&](int, const void* bytes, std::size_t size) -> ssize_t {
    if (signals-- > 0) return test::failed(EINTR);
    taken.append(static_cast<const char*>(bytes), size);
    return static_cast<ssize_t>(size);
  };
  CHECK(terminal.pty->write("cd") == 2);
  CHECK(taken == "cd");
}

TEST_CASE("pty line: a read and a write of nothing have none of the errors of before") {
  Terminal terminal;
  errno = 0;
  const int stale = GENERATE(EINTR, EIO);
  int opened = 0;
  terminal.kernel.open = [&](const char*) {
    ++opened;
    return test::failed(ENOENT);
  };
  terminal.kernel.ready = [](short) { return static_cast<short>(POLLIN); };
  CHECK(terminal.pty->attached());
  terminal.kernel.read = [&](int, void*, std::size_t) -> ssize_t {
    errno = stale;
    return 0;
  };
  std::array<char, 8> room{};
  CHECK(terminal.pty->read(room) == 0);
  CHECK(opened == 0);  // the line is renewed when a program has left
  terminal.kernel.write = [&](int, const void*, std::size_t) -> ssize_t {
    errno = stale;
    return 0;
  };
  CHECK(terminal.pty->write("abc") == 0);
}

TEST_CASE("pty line: a program that has left is seen by the read, once") {
  Terminal terminal;
  int opened = 0;
  terminal.kernel.open = [&](const char*) {
    ++opened;
    return test::failed(ENOENT);
  };
  terminal.kernel.ready = [](short) { return static_cast<short>(POLLIN); };
  CHECK(terminal.pty->attached());
  terminal.kernel.read = [](int, void*, std::size_t) -> ssize_t { return test::failed(EIO); };
  std::array<char, 8> room{};
  CHECK(terminal.pty->read(room) == 0);
  CHECK(terminal.pty->read(room) == 0);
  CHECK(opened == 1);
}

TEST_CASE("pty line: a text goes in the parts that the line takes") {
  Terminal terminal;
  std::string taken;
  terminal.kernel.ready = [](short) { return short{0}; };
  terminal.kernel.write = [&](int, const void* bytes, std::size_t) -> ssize_t {
    if (taken.size() == 3) return test::failed(EAGAIN);
    taken += *static_cast<const char*>(bytes);
    return 1;
  };
  CHECK(terminal.pty->write("abcde") == 3);
  CHECK(taken == "abc");
}

TEST_CASE("pty line: a line of which no program reads is written nothing") {
  Terminal terminal;
  terminal.kernel.ready = [](short) { return static_cast<short>(POLLHUP); };
  bool written = false;
  terminal.kernel.write = [&](int, const void*, std::size_t size) {
    written = true;
    return static_cast<ssize_t>(size);
  };
  CHECK(terminal.pty->write("abc") == 0);
  CHECK_FALSE(written);
}

/// How often the lock of a link was tried for, and how often there was a pause between.
struct Locking {
  Locking() {
    kernel.flock = [this](int, int) { return ++tries <= refused ? test::failed(EWOULDBLOCK) : 0; };
    kernel.usleep = [this](useconds_t time) {
      ++pauses;
      paused_us += time;
    };
  }
  test::PlayedKernel kernel;
  test::TemporaryDirectory folder;
  std::string link = folder.path() + "/central";
  int refused = 0;
  int tries = 0;
  int pauses = 0;
  useconds_t paused_us = 0;
};

TEST_CASE("pty line: a lock that another program has for a moment is tried for six times") {
  Locking locking;
  locking.refused = 5;
  CHECK(Pty::open(locking.link));
  CHECK(locking.tries == 6);
  CHECK(locking.pauses == 5);
  CHECK(locking.paused_us == 5000);
}

TEST_CASE("pty line: a lock that another program keeps is that of one that serves the link") {
  Locking locking;
  locking.refused = 6;
  CHECK(Pty::open(locking.link).error ==
        Failure{"another program serves '" + locking.link + "'",
                "end it (`fuser -v " + locking.link + ".lock` names it), or choose another path"});
  CHECK(locking.tries == 6);
  CHECK(locking.pauses == 5);
}

TEST_CASE("pty line: a lock whose name was taken away meanwhile is made again") {
  Locking locking;
  locking.kernel.flock = [&](int, int) {
    if (++locking.tries == 1) std::filesystem::remove(locking.link + ".lock");
    return 0;
  };
  const auto pty = Pty::open(locking.link);
  REQUIRE(pty);
  CHECK(locking.tries == 2);
  CHECK(std::filesystem::exists(locking.link + ".lock"));
}

TEST_CASE("pty line: a lock that another program has made again meanwhile is not the one that is held") {
  Locking locking;
  const std::string lock = locking.link + ".lock";
  locking.kernel.flock = [&](int, int) {
    if (++locking.tries == 1) {
      std::ofstream{lock + ".new"} << "";  // beside the old one, so that their numbers differ
      std::filesystem::rename(lock + ".new", lock);
    }
    return 0;
  };
  REQUIRE(Pty::open(locking.link));
  CHECK(locking.tries == 2);
}

TEST_CASE("pty line: a lock that is made again, and then taken away, is neither") {
  Locking locking;
  const std::string lock = locking.link + ".lock";
  locking.kernel.flock = [&](int, int) {
    if (++locking.tries == 1) {
      std::ofstream{lock + ".new"} << "";
      std::filesystem::rename(lock + ".new", lock);
    }
    if (locking.tries == 2) std::filesystem::remove(lock);
    return 0;
  };
  const auto pty = Pty::open(locking.link);
  REQUIRE(pty);
  CHECK(locking.tries == 3);
  CHECK(std::filesystem::exists(lock));
}

TEST_CASE("pty line: whether a link is served is asked without waiting, and of the lock's owner alone") {
  Locking locking;
  std::ofstream{locking.link + ".lock"} << "";
  int asked = 0;
  locking.kernel.flock = [&](int, int what) {
    asked = what;
    return test::failed(EWOULDBLOCK);
  };
  CHECK(transport::is_served(locking.link));
  CHECK(asked == (LOCK_SH | LOCK_NB));
}

TEST_CASE("pty line: a pty that moves takes its link along, and one that is replaced takes its own away") {
  const test::TemporaryDirectory folder;
  const std::string first = folder.path() + "/first";
  const std::string second = folder.path() + "/second";
  const auto is_there = [](const std::string& link) {
    return std::filesystem::exists(std::filesystem::symlink_status(link));
  };
  auto one = Pty::open(first);
  auto two = Pty::open(second);
  REQUIRE(one);
  REQUIRE(two);
  const std::string path = two->path();
  const int file = two->descriptor();
  *one = std::move(*two);
  CHECK_FALSE(is_there(first));
  CHECK_FALSE(std::filesystem::exists(first + ".lock"));
  CHECK(is_there(second));
  CHECK(transport::is_served(second));
  CHECK(one->name() == second);
  CHECK(one->path() == path);
  CHECK(one->descriptor() == file);
  Pty& same = *one;
  *one = std::move(same);
  CHECK(is_there(second));
  const Pty moved{std::move(*one)};
  CHECK(moved.name() == second);
  CHECK(moved.path() == path);
  CHECK(moved.descriptor() == file);
}

TEST_CASE("pty line: a pty that moves knows that a program has it open") {
  auto pty = Pty::open();
  REQUIRE(pty);
  const std::string path = pty->path();
  const auto program = [&path] { return host::Descriptor{::open(path.c_str(), O_RDWR | O_NOCTTY)}; };
  const auto raw = [&path] {  // as the one behind left it
    const host::Descriptor line{::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK)};
    termios settings{};
    REQUIRE(::tcgetattr(line.get(), &settings) == 0);
    return (settings.c_lflag & ECHO) == 0;
  };
  const auto echo = [](int file) {
    termios settings{};
    REQUIRE(::tcgetattr(file, &settings) == 0);
    settings.c_lflag |= ECHO;
    REQUIRE(::tcsetattr(file, TCSANOW, &settings) == 0);
  };
  {
    const auto first = program();
    CHECK(pty->attached());
    echo(first.get());
  }
  Pty moved{std::move(*pty)};
  CHECK_FALSE(moved.attached());
  CHECK(raw());
  {
    const auto second = program();
    CHECK(moved.attached());
    echo(second.get());
  }
  Pty assigned;
  assigned = std::move(moved);
  CHECK_FALSE(assigned.attached());
  CHECK(raw());
}

TEST_CASE("pty line: a folder in the place of the link is no link, and keeps no lock") {
  const test::TemporaryDirectory folder;
  const std::string link = folder.path() + "/central";
  std::filesystem::create_directory(link);
  CHECK(Pty::open(link).error ==
        Failure{"'" + link + "' is there, and no link", "remove it, or choose another path"});
  CHECK_FALSE(std::filesystem::exists(link + ".lock"));
}

TEST_CASE("pty line: a link that cannot be made says so, and keeps no lock") {
  Locking locking;
  locking.kernel.symlink = [] { return test::failed(EROFS); };
  CHECK(
      Pty::open(locking.link).error ==
      Failure{"cannot make the link '" + locking.link + "': " + std::strerror(EROFS), "choose another path"});
  CHECK(std::filesystem::is_empty(locking.folder.path()));
}

}  // namespace transport_serial_port_line_test
