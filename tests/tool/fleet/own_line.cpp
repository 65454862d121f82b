// A central's line that goes while this program has it.
#include "cli/fleet/own_line.hpp"

#include <chrono>
#include <cstdlib>
#include <fcntl.h>
#include <string>
#include <utility>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "ocm/host/descriptor.hpp"

#include "cli/shared/messages.hpp"
#include "tests/tool/captured.hpp"

namespace fleet_own_line_test {

using namespace std::chrono_literals;
using namespace ocm;
using namespace ocm::test;

TEST_CASE("own line: a line that is gone is said once, whether it is noticed by writing or by reading") {
  for (const bool writes : {true, false}) {
    CAPTURE(writes);
    host::Descriptor dongle{::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)};
    REQUIRE(dongle);
    REQUIRE(::grantpt(dongle.get()) == 0);
    REQUIRE(::unlockpt(dongle.get()) == 0);
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

}  // namespace fleet_own_line_test
