#include "ocm/host/local_listener.hpp"

#include <chrono>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <sys/file.h>
#include <thread>

#include <catch2/catch.hpp>

#include "ocm/transport/virtual_bus.hpp"

#include "unit/host/host_testing.hpp"

namespace host_local_listener_test {

using namespace ocm;
using namespace ocm::test;
using namespace std::chrono_literals;
using host::LocalListener;

constexpr host::LocalService service{"a virtual bus", "a simulator", host::Cause::simulator_running};

TEST_CASE("the socket of a dead server is replaced, and nothing else is") {
  const TemporaryDirectory directory;
  const std::string path = directory.path() + "/sim.sock";
  CHECK(in_child([&] {
          const auto server = LocalListener::open(path, 1s, service);
          ::_exit(server ? 0 : 1);  // at once, without cleaning up
          return 2;
        }) == 0);
  CHECK(std::filesystem::is_socket(path));
  {
    const auto server = LocalListener::open(path, 1s, service);
    INFO(server.error.what);
    CHECK(server);
    CHECK(transport::VirtualBus::running(path));
  }
  CHECK_FALSE(std::filesystem::exists(path));

  std::ofstream{path} << "precious";
  const auto refused = LocalListener::open(path, 1s, service);
  CHECK_THAT(refused.error.what, Catch::Contains("is not a socket") && Catch::Contains(path));
  CHECK(std::filesystem::file_size(path) == 8);
  std::filesystem::remove(path);

  // A socket of another kind, on which a program listens.
  const auto address = host::to_address(path);
  const host::Descriptor stream{::socket(AF_UNIX, SOCK_STREAM, 0)};
  REQUIRE(::bind(stream.get(), reinterpret_cast<const sockaddr*>(&*address), sizeof *address) == 0);
  REQUIRE(::listen(stream.get(), 1) == 0);
  CHECK_THAT(LocalListener::open(path, 1s, service).error.what, Catch::Contains("another program listens"));
}

TEST_CASE("a server waits for another one that starts, and no longer than it may") {
  const TemporaryDirectory directory;
  const std::string path = directory.path() + "/sim.sock";
  host::Descriptor other{::open(directory.path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  REQUIRE(::flock(other.get(), LOCK_EX) == 0);
  const auto start = std::chrono::steady_clock::now();
  const auto refused = LocalListener::open(path, 30ms, service);
  CHECK_THAT(refused.error.what, Catch::Contains("holds the lock of the directory"));
  CHECK_THAT(refused.error.remedy, Catch::Contains("fuser " + directory.path()));
  CHECK(std::chrono::steady_clock::now() - start >= 30ms);
  std::thread starts{[&] {
    std::this_thread::sleep_for(30ms);
    other.reset();
  }};
  CHECK(LocalListener::open(path, 1h, service));
  starts.join();
  CHECK(std::chrono::steady_clock::now() - start < 9s);  // it looks again soon
}

TEST_CASE("only what is its own is removed") {
  const TemporaryDirectory directory;
  const std::string path = directory.path() + "/sim.sock";
  auto first = LocalListener::open(path, 1s, service);
  REQUIRE(first);
  CHECK(first->is_found());
  std::filesystem::remove(path);
  CHECK_FALSE(first->is_found());
  const auto second = LocalListener::open(path, 1s, service);
  REQUIRE(second);
  CHECK_FALSE(first->is_found());
  CHECK(second->is_found());
  first.value = {};
  CHECK(transport::VirtualBus::running(path));
}

TEST_CASE("a socket that was moved stays, and goes with its last owner") {
  const TemporaryDirectory directory;
  const std::string path = directory.path() + "/sim.sock";
  auto opened = LocalListener::open(path, 1s, service);
  REQUIRE(opened);
  {
    const LocalListener owner{std::move(opened.value)};
    opened.value = {};
    CHECK(owner.path() == path);
    CHECK(owner.descriptor() >= 0);
    CHECK(std::filesystem::is_socket(path));
  }
  CHECK_FALSE(std::filesystem::exists(path));
}

}  // namespace host_local_listener_test
