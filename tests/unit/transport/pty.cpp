#include "ocm/transport/pty.hpp"

#include <array>
#include <filesystem>
#include <fstream>
#include <poll.h>
#include <set>
#include <string>
#include <string_view>

#include <catch2/catch.hpp>

#include "ocm/transport/serial_port.hpp"

namespace transport_pty_test {

using namespace ocm;
using Catch::Contains;
using host::Descriptor;
using transport::Pty;

std::string all(Pty& pty) {
  std::string text;
  std::array<char, 64> room{};
  while (const std::size_t size = pty.read(room)) text.append(room.data(), size);
  return text;
}
/// The other program: opens it, and takes it as it is.
class Program {
 public:
  explicit Program(const std::string& path)
      : line_(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
    REQUIRE(line_);
  }
  void write(std::string_view text) const {
    REQUIRE(::write(line_.get(), text.data(), text.size()) == static_cast<ssize_t>(text.size()));
  }
  [[nodiscard]] std::string read() const {
    std::array<char, 4096> room{};
    std::string text;
    for (ssize_t size = 0; (size = ::read(line_.get(), room.data(), room.size())) > 0;)
      text.append(room.data(), static_cast<std::size_t>(size));
    return text;
  }
  [[nodiscard]] int descriptor() const { return line_.get(); }

 private:
  Descriptor line_;
};
/// A folder that goes with the test.
struct Folder {
  Folder() {
    char name[] = "/tmp/ocm-pty-XXXXXX";
    REQUIRE(::mkdtemp(name) != nullptr);
    path = name;
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() { std::filesystem::remove_all(path); }
  [[nodiscard]] std::string file(const char* name) const { return path + "/" + name; }
  std::string path;
};

TEST_CASE("pty: bytes go both ways as they are, and nothing is echoed") {
  auto pty = Pty::open();
  REQUIRE(pty);
  CHECK(pty->name() == pty->path());
  const Program program{pty->path()};
  CHECK(pty->attached());
  std::string every;
  for (int byte = 0; byte < 256; ++byte) every += static_cast<char>(byte);
  program.write(every);
  CHECK(all(*pty) == every);
  CHECK(pty->write(every) == 256);
  CHECK(all(*pty).empty());  // and takes nothing from the program
  CHECK(program.read() == every);
  CHECK(all(*pty).empty());
  CHECK(program.read().empty());
}

TEST_CASE("pty: programs come and go, and none reads what was for another") {
  auto pty = Pty::open();
  REQUIRE(pty);
  CHECK_FALSE(pty->attached());
  CHECK(pty->write("not heard\n") == 0);
  {
    const Program first{pty->path()};
    CHECK(pty->attached());
    CHECK(first.read().empty());
    CHECK(pty->write("for the first\n") == 14);
    // The kernel hands it on when it has time; it must not be echoed by what comes next.
    pollfd arrived{first.descriptor(), POLLIN, 0};
    REQUIRE(::poll(&arrived, 1, 10'000) == 1);
    // What it does to the line goes with it.
    termios settings{};
    REQUIRE(::tcgetattr(first.descriptor(), &settings) == 0);
    settings.c_lflag |= ECHO | ICANON;
    settings.c_oflag |= OPOST | ONLCR;
    REQUIRE(::tcsetattr(first.descriptor(), TCSANOW, &settings) == 0);
    first.write("last words");
  }
  CHECK(pty->attached());  // they are to be read
  CHECK(all(*pty).substr(0, 10) == "last words");
  CHECK_FALSE(pty->attached());
  CHECK(pty->write("not heard\n") == 0);
  const Program second{pty->path()};
  CHECK(pty->attached());
  CHECK(second.read().empty());
  CHECK(pty->write("for the second\n") == 15);
  CHECK(second.read() == "for the second\n");
  CHECK(all(*pty).empty());  // no echo any more
}

TEST_CASE("pty: a program that does not read fills the line, and the rest is not taken") {
  auto pty = Pty::open();
  REQUIRE(pty);
  const Program program{pty->path()};
  const std::string block(1000, 'x');
  std::size_t taken = 0;
  for (int i = 0; i < 1000; ++i) taken += pty->write(block);
  CHECK(taken > 1000);
  CHECK(taken < 1'000'000);
  std::size_t read = 0;
  for (std::string text; !(text = program.read()).empty();) read += text.size();
  CHECK(read == taken);
  CHECK(pty->write("on") == 2);
}

TEST_CASE("pty: the link is there while its owner lives, and one at a time") {
  const Folder folder;
  const std::string link = folder.file("central");
  CHECK_FALSE(transport::is_served(link));
  {
    auto pty = Pty::open(link);
    REQUIRE(pty);
    CHECK(pty->name() == link);
    CHECK(std::filesystem::read_symlink(link) == pty->path());
    CHECK(transport::is_served(link));
    using std::filesystem::perms;
    CHECK(std::filesystem::status(link + ".lock").permissions() == (perms::owner_read | perms::owner_write));
    {
      const Program program{link};
      CHECK(pty->attached());
      program.write("start\n");
      CHECK(all(*pty) == "start\n");
    }
    const auto second = Pty::open(link);
    REQUIRE_FALSE(second);
    CHECK_THAT(second.error.what, Contains("another program serves '" + link + "'"));
    CHECK(std::filesystem::read_symlink(link) == pty->path());  // it is the first one's still

    Pty moved = std::move(*pty);
    CHECK(std::filesystem::exists(std::filesystem::symlink_status(link)));
  }
  CHECK(std::filesystem::is_empty(folder.path));
  REQUIRE(Pty::open(link));
}

TEST_CASE("pty: what a killed program has left is replaced, but never something that is no link") {
  const Folder folder;
  const std::string link = folder.file("central");
  std::filesystem::create_symlink("/dev/pts/no-such-line", link);
  CHECK_FALSE(transport::is_served(link));
  std::ofstream{link + ".lock"} << "";
  CHECK_FALSE(transport::is_served(link));
  {
    const auto pty = Pty::open(link);
    REQUIRE(pty);
    CHECK(std::filesystem::read_symlink(link) == pty->path());
  }
  std::ofstream{link} << "mine";
  const auto refused = Pty::open(link);
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error.what, Contains("'" + link + "' is there, and no link"));
  CHECK(std::filesystem::file_size(link) == 4);
  CHECK_FALSE(std::filesystem::exists(link + ".lock"));
  const auto nowhere = Pty::open(folder.file("no/such/folder"));
  REQUIRE_FALSE(nowhere);
  CHECK_THAT(nowhere.error.what, Contains("cannot write '" + folder.file("no/such/folder.lock")));
}

TEST_CASE("pty: lines of a user lie beside the virtual bus, in folders of the user alone") {
  const Folder folder;
  const char* before = std::getenv("XDG_RUNTIME_DIR");
  const std::string kept = before == nullptr ? "" : before;
  ::setenv("XDG_RUNTIME_DIR", folder.path.c_str(), 1);
  CHECK(transport::central_line() == folder.path + "/ocm/central");
  CHECK(transport::robot_lines() == folder.path + "/ocm/line");
  CHECK_FALSE(transport::make_line_folders());
  CHECK_FALSE(transport::make_line_folders());
  CHECK(std::filesystem::is_directory(transport::robot_lines()));
  for (const std::string& made : {folder.path + "/ocm", transport::robot_lines()})
    CHECK(std::filesystem::status(made).permissions() == std::filesystem::perms::owner_all);
  std::filesystem::permissions(transport::robot_lines(), std::filesystem::perms::others_read,
                               std::filesystem::perm_options::add);
  const auto problem = transport::make_line_folders();
  REQUIRE(problem);
  CHECK_THAT(problem->what, Contains("is open to other users"));
  if (before == nullptr)
    ::unsetenv("XDG_RUNTIME_DIR");
  else
    ::setenv("XDG_RUNTIME_DIR", kept.c_str(), 1);
}

TEST_CASE("pty: a serial port at the other end sees it go") {
  auto pty = Pty::open();
  REQUIRE(pty);
  auto port = transport::SerialPort::open(pty->path());
  REQUIRE(port);
  CHECK(pty->attached());
  CHECK(pty->write("{S,IDL}\n") == 8);
  *pty = Pty{};
  std::array<char, 64> room{};
  // What was on its way may go with the line; then it is gone.
  auto got = port->read(room);
  while (got && *got != 0) got = port->read(room);
  CHECK(got.error == base::Error::closed);
  CHECK_THAT(port->failure().what, Contains("is gone"));
}

TEST_CASE("pty: each robot has a line of its own, whose name a file can have") {
  CHECK(transport::line_name("AVR") == "AVR");
  CHECK(transport::line_name("room/2") == "room%2F2");
  CHECK(transport::line_name("..") == "%2E.");
  CHECK(transport::line_name("AVR.lock") == "AVR%2Elock");
  CHECK(transport::line_name("v1.2%") == "v1.2%25");
  CHECK(transport::robot_of_line("100%") == "100%");
  CHECK(transport::robot_of_line("%2") == "%2");
  CHECK(transport::robot_of_line("%2f%ZZ") == "%2f%ZZ");
  CHECK(transport::robot_of_line("%09%A0") == "\x09\xA0");
  std::set<std::string> names;
  std::size_t robots = 0;
  constexpr std::string_view letters = "./%2F5";
  for (std::size_t number = 0; number < 6 * 6 * 6 * 6; ++number, ++robots) {
    std::string robot;
    for (std::size_t rest = number, i = 0; i < 4; ++i, rest /= 6) robot += letters[rest % 6];
    const std::string name = transport::line_name(robot);
    CHECK(name.find('/') == std::string::npos);
    CHECK(transport::robot_of_line(name) == robot);
    names.insert(name);
  }
  CHECK(names.size() == robots);
}

}  // namespace transport_pty_test
