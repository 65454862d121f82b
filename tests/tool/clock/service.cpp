// What an operator that systemd runs reports to it, by the variables of sd_notify(3).
#include "cli/operate/service.hpp"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <iterator>
#include <string>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <catch2/catch.hpp>

#include "ocm/host/descriptor.hpp"

#include "tests/tool/clock/world.hpp"

namespace tool_clock_service_test {

using namespace ocm;
using namespace ocm::test;
using cli::operate::Service;

void set(const char* name, const char* value) {
  if (value != nullptr)
    ::setenv(name, value, 1);
  else
    ::unsetenv(name);
}
/// One that is started with these variables; null: it is not set.
Service started(const char* socket, const char* usec, const char* process = nullptr) {
  set("NOTIFY_SOCKET", socket);
  set("WATCHDOG_USEC", usec);
  set("WATCHDOG_PID", process);
  Service service;
  CHECK(std::getenv("NOTIFY_SOCKET") == nullptr);  // what it starts is no part of it
  set("WATCHDOG_USEC", nullptr);
  set("WATCHDOG_PID", nullptr);
  return service;
}

TEST_CASE(
    "service: it reports to systemd's watchdog twice in its time, where it asks this process for that") {
  const World world{1};
  constexpr auto never = Moment::max();
  for (const char* const usec : {static_cast<const char*>(nullptr), "", "soon", "-5", "0", "1"})
    CHECK(started("@none", usec).next() == never);
  CHECK(started(nullptr, "4000000").next() == never);
  CHECK(started("@none", "4000000", "1").next() == never);  // another process is meant
  CHECK(started("@none", "2").next() != never);
  CHECK(started("@none", "4000000", std::to_string(::getpid()).c_str()).next() != never);
  Service service = started("@none", "4000000");
  CHECK(service.next() == world.now());
  const Moment begin = world.now();
  service.runs(begin);
  CHECK(service.next() == begin + 2s);
  service.runs(begin + 2s - 1ns);
  CHECK(service.next() == begin + 2s);
  service.runs(begin + 2s);
  CHECK(service.next() == begin + 4s);
  Service longest = started("@none", "9223372036854775807");
  longest.runs(world.now());
  CHECK(longest.next() > world.now() + 24h);
}

/// What comes to an abstract socket of this name when an operator begins that has the name, and `behind` it;
/// "": the name is taken.
std::string heard_at(const std::string& name, const std::string& behind = "") {
  const host::Descriptor socket{::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)};
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::copy(name.begin(), name.end(), std::begin(address.sun_path) + 1);
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  if (::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), size) != 0) return {};
  started(("@" + name + behind).c_str(), nullptr).ready("operator guard is in driving");
  std::string heard(200, '\0');
  const auto count = ::recv(socket.get(), heard.data(), heard.size(), 0);
  if (count < 0 && errno == EAGAIN) return "nothing";
  REQUIRE(count > 0);
  return heard.substr(0, static_cast<std::size_t>(count));
}

TEST_CASE("service: a socket of systemd may be an abstract one, with a name of any length") {
  const World world{1};
  constexpr const char* ready = "READY=1\nSTATUS=operator guard is in driving";
  std::string name = "ocm-service-" + std::to_string(::getpid());
  CHECK(heard_at(name) == ready);
  name.resize(sizeof(sockaddr_un::sun_path) - 1, 'x');
  CHECK(heard_at(name) == ready);
  std::string heard;
  for (char letter = 'a'; letter <= 'z' && heard.empty(); ++letter) heard = heard_at(std::string(1, letter));
  CHECK(heard == ready);
  CHECK(heard_at(name, "x") == "nothing");  // longer than a name can be
}

}  // namespace tool_clock_service_test
