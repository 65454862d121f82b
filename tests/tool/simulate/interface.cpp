// Messages that are simulated on a CAN interface, which goes down meanwhile, on a kernel that is played.
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <net/if.h>
#include <string>
#include <sys/types.h>
#include <unistd.h>

#include <catch2/catch.hpp>

#include "cli/simulate/run.hpp"
#include "tests/tool/captured.hpp"
#include "unit/host/host_testing.hpp"
#include "unit/transport/played_can.hpp"

namespace simulate_interface_test {

using namespace std::chrono_literals;
using namespace ocm;

/// Of can7 with one message, in a process of its own, which is interrupted after 200 ms.
int code_of_messages_on_can7(const std::string& spec) {
  return test::in_child([&spec] {
    test::PlayedCan can;
    const auto send = can.kernel.send;
    can.kernel.send = [&can, send](int file, const void* bytes, std::size_t size, int flags) -> ssize_t {
      if (file == can.socket && can.flags == 0) return test::failed(ENETDOWN);
      return send(file, bytes, size, flags);
    };
    can.kernel.later(20ms, [&can] {
      can.flags = 0;
      can.errors.push_back(ENETDOWN);
    });
    can.kernel.later(100ms, [&can] {
      can.flags = IFF_UP;
      can.wake = true;
    });
    can.kernel.later(200ms, [&can] {
      ::raise(SIGINT);
      can.kernel.interrupt();
    });
    try {
      cli::Session session;
      session.bus_name = "can7";
      session.spec_files = {spec};
      return cli::simulate::run_messages({}, session);
    } catch (const cli::Exit& exit) {
      return exit.code;
    } catch (...) {
      return 0;
    }
  });
}

TEST_CASE("sim: of a CAN interface it is said when it goes down, and when it is up again") {
  const test::TemporaryDirectory folder;
  const std::string spec = folder.file("car.json");
  std::ofstream{spec} << R"({"robot": "car", "messages": [
    {"name": "Engine", "id": "0x123", "length": 1, "period": "1s", "fields": []}]})";
  test::Captured said{STDERR_FILENO};
  const int code = code_of_messages_on_can7(spec);
  const std::string text = said.text();
  CAPTURE(text);
  CHECK(code == 128 + SIGINT);
  CHECK_THAT(text, Catch::StartsWith("bus: can7\nsimulated 1 message of car on can7; Ctrl-C ends it\n"
                                     "can7 went down; waiting for it to come back\ncan7 is up again\n"));
  CHECK_THAT(text, Catch::EndsWith(" dropped: the bus was full\n"));
}

}  // namespace simulate_interface_test
