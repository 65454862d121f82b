// The side of a central's server: what is waited for there.
#include "cli/central/server_end.hpp"

#include <fcntl.h>
#include <poll.h>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/host/descriptor.hpp"

namespace fleet_server_end_test {

using namespace ocm;

TEST_CASE("server end: a pseudo terminal is waited for as long as a program has it open") {
  auto pty = transport::Pty::open();
  REQUIRE(pty);
  const std::string path = pty->path();
  const int descriptor = pty->descriptor();
  const auto end = cli::central::pseudo_terminal(std::move(*pty));
  const auto watched = [&end](bool reads, bool writes) {
    std::vector<pollfd> inputs;
    end->watch(inputs, reads, writes);
    return inputs;
  };
  CHECK_FALSE(end->attached());
  CHECK(watched(true, true).empty());  // it would be ready all the time
  host::Descriptor program{::open(path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC)};
  REQUIRE(program);
  CHECK(end->attached());
  for (const bool reads : {false, true})
    for (const bool writes : {false, true}) {
      CAPTURE(reads, writes);
      const auto inputs = watched(reads, writes);
      REQUIRE(inputs.size() == 1);
      CHECK(inputs[0].fd == descriptor);
      CHECK(inputs[0].events == ((reads ? POLLIN : 0) | (writes ? POLLOUT : 0)));
    }
  program.reset();
  CHECK_FALSE(end->attached());
  CHECK(watched(true, true).empty());
  CHECK_FALSE(end->over());  // another may come
}

}  // namespace fleet_server_end_test
