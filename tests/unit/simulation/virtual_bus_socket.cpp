#include "ocm/simulation/virtual_bus_socket.hpp"

#include <filesystem>
#include <fstream>

#include <catch2/catch.hpp>

#include "ocm/transport/virtual_bus.hpp"

#include "unit/host/host_testing.hpp"

namespace simulation_virtual_bus_socket_test {

using namespace ocm;
using namespace ocm::test;
using namespace std::chrono_literals;
using simulation::VirtualBusSocket;
namespace vb = transport::virtual_bus;

TEST_CASE("the socket of a dead server is replaced, and nothing else is") {
  const TemporaryDirectory directory;
  const std::string path = directory.path() + "/sim.sock";
  CHECK(in_child([&] {
          const auto server = VirtualBusSocket::open(path, 1s);
          ::_exit(server ? 0 : 1);  // at once, without cleaning up
          return 2;
        }) == 0);
  CHECK(std::filesystem::is_socket(path));
  {
    const auto server = VirtualBusSocket::open(path, 1s);
    INFO(server.error.what);
    CHECK(server);
    CHECK(transport::VirtualBus::running(path));
  }
  CHECK_FALSE(std::filesystem::exists(path));

  std::ofstream{path} << "precious";
  const auto refused = VirtualBusSocket::open(path, 1s);
  CHECK_THAT(refused.error.what, Catch::Contains("is not a socket") && Catch::Contains(path));
  CHECK(std::filesystem::file_size(path) == 8);
  std::filesystem::remove(path);

  // A socket of another kind, on which a program listens.
  const auto address = vb::to_address(path);
  const host::Descriptor stream{::socket(AF_UNIX, SOCK_STREAM, 0)};
  REQUIRE(::bind(stream.get(), reinterpret_cast<const sockaddr*>(&*address), sizeof *address) == 0);
  REQUIRE(::listen(stream.get(), 1) == 0);
  CHECK_THAT(VirtualBusSocket::open(path, 1s).error.what, Catch::Contains("another program listens"));
}

TEST_CASE("only what is its own is removed") {
  const TemporaryDirectory directory;
  const std::string path = directory.path() + "/sim.sock";
  auto first = VirtualBusSocket::open(path, 1s);
  REQUIRE(first);
  std::filesystem::remove(path);
  const auto second = VirtualBusSocket::open(path, 1s);
  REQUIRE(second);
  first.value = {};
  CHECK(transport::VirtualBus::running(path));
}

TEST_CASE("a socket that was moved stays, and goes with its last owner") {
  const TemporaryDirectory directory;
  const std::string path = directory.path() + "/sim.sock";
  auto opened = VirtualBusSocket::open(path, 1s);
  REQUIRE(opened);
  {
    const VirtualBusSocket owner{std::move(opened.value)};
    opened.value = {};
    CHECK(owner.path() == path);
    CHECK(owner.descriptor() >= 0);
    CHECK(std::filesystem::is_socket(path));
  }
  CHECK_FALSE(std::filesystem::exists(path));
}

}  // namespace simulation_virtual_bus_socket_test
