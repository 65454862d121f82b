// What is said where no simulator serves the bus that is meant, and whether mappers run in its place.
#include "cli/shared/buses.hpp"

#include <filesystem>
#include <string>
#include <sys/socket.h>
#include <sys/un.h>

#include <catch2/catch.hpp>

#include "ocm/host/descriptor.hpp"
#include "ocm/host/local_socket.hpp"
#include "ocm/transport/interfaces.hpp"
#include "ocm/transport/pty.hpp"
#include "ocm/transport/virtual_bus_protocol.hpp"

#include "cli/shared/messages.hpp"
#include "tests/tool/captured.hpp"
#include "unit/host/host_testing.hpp"

namespace tool_shared_buses_test {

using namespace ocm;
using transport::Pty;

/// Where programs of this user meet, for one test alone.
struct Place {
  test::TemporaryDirectory folder;
  test::Environment runtime{"XDG_RUNTIME_DIR", folder.path().c_str()};
  Place() { REQUIRE_FALSE(transport::make_line_folders().has_value()); }
};

/// What is wrong, and on the next line the remedy.
std::string said_of(const std::string& bus) {
  const auto opened = cli::open_bus(cli::parse_bus_name(bus));
  REQUIRE_FALSE(opened);
  return opened.error.what + "\n" + opened.error.remedy;
}
bool says_that_mappers_run() {
  return said_of("sim").find("; mappers run, but have no CAN bus\nmappers take `amiroctl robots`") !=
         std::string::npos;
}

TEST_CASE("buses: where mappers run and no simulator, that is said of the usual bus, and not of a path") {
  const Place place;
  const auto none = [](const std::string& path) {
    return "no simulator is running: no program listens on '" + path + "'";
  };
  const std::string usual = transport::virtual_bus::default_path(), other = place.folder.file("other.sock");
  const std::string of_other = none(other) + "\nstart one with `amiroctl sim --bus sim:" + other + "`";
  CHECK(said_of("sim") == none(usual) + "\nstart one");
  CHECK(said_of("sim:" + other) == of_other);
  const auto central = Pty::open(transport::central_line());
  REQUIRE(central);
  CHECK_THAT(said_of("sim"), Catch::StartsWith(none(usual) + "; mappers run"));
  CHECK(says_that_mappers_run());
  CHECK(said_of("sim:" + other) == of_other);
}

TEST_CASE("buses: where none is chosen and there is none, it is said whether mappers run") {
  for (const auto& interface : transport::can_interfaces())
    if (interface.up) {
      WARN("this machine has a CAN interface that is up");
      return;
    }
  const Place place;
  const auto left = [] { return test::leaving([] { static_cast<void>(cli::only_bus()); }); };
  const auto none = left();
  CHECK(none.code == cli::exit_failure);
  CHECK(
      none.text ==
      "amiroctl: no bus: no CAN interface is up and no simulator runs\n"
      "          start a simulated robot with `amiroctl sim`, the messages of a DBC file with `amiroctl sim "
      "--spec FILE`, or bring an interface up: sudo ip link set can0 up type can bitrate 500000\n");
  const auto central = Pty::open(transport::central_line());
  REQUIRE(central);
  const auto mappers = left();
  CHECK(mappers.code == cli::exit_failure);
  CHECK(
      mappers.text ==
      "amiroctl: no bus: mappers run, but have no CAN bus, and no CAN interface is up\n"
      "          mappers take `amiroctl robots`, `goto`, `pause` and `map`; an AMiRo with a bus is `amiroctl "
      "sim`, which may run beside them\n");
}

TEST_CASE("buses: a robot's own line shows that mappers run, as long as a program has it") {
  const Place place;
  const std::string lines = transport::robot_lines() + "/";
  std::filesystem::create_symlink("/dev/null", lines + "left");
  CHECK_FALSE(says_that_mappers_run());
  {
    const auto robot = Pty::open(lines + "AVR");
    REQUIRE(robot);
    CHECK(says_that_mappers_run());
  }
  CHECK_FALSE(says_that_mappers_run());
}

TEST_CASE("buses: a socket that is not of a simulator is said, also where mappers run") {
  const Place place;
  const std::string path = transport::virtual_bus::default_path();
  const auto address = host::to_address(path);
  REQUIRE(address);
  const host::Descriptor other{::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)};
  REQUIRE(::bind(other.get(), reinterpret_cast<const sockaddr*>(&*address), sizeof *address) == 0);
  REQUIRE(::listen(other.get(), 1) == 0);
  const std::string no_simulator = "'" + path + "' is a socket, but not of a simulator\nname another path";
  CHECK(said_of("sim") == no_simulator);
  const auto central = Pty::open(transport::central_line());
  REQUIRE(central);
  CHECK(said_of("sim") == no_simulator);
  CHECK(said_of("sim:" + path) == no_simulator);
}

}  // namespace tool_shared_buses_test
