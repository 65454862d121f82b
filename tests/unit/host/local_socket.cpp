#include "ocm/host/local_socket.hpp"

#include <string>
#include <unistd.h>

#include <catch2/catch.hpp>

#include "ocm/host/descriptor.hpp"

namespace host_local_socket_test {

using namespace ocm;

TEST_CASE("a path that no socket can have") {
  CHECK(host::to_address("/tmp/" + std::string(102, 'x')).ok());
  const auto refused = host::to_address("/tmp/" + std::string(103, 'x'));
  CHECK_THAT(refused.error.what, Catch::Contains("108 bytes"));
  CHECK_THAT(refused.error.remedy, Catch::Contains("107"));
  CHECK_FALSE(host::to_address(""));
  CHECK_FALSE(host::to_address(std::string("a\0b", 3)));
}

TEST_CASE("the other end of a socket is named by its process") {
  int ends[2];
  REQUIRE(::socketpair(AF_UNIX, SOCK_SEQPACKET, 0, ends) == 0);
  const host::Descriptor first{ends[0]};
  const host::Descriptor second{ends[1]};
  const auto peer = host::peer_of(first.get());
  REQUIRE(peer);
  CHECK(peer->uid == ::geteuid());
  CHECK(host::process_text(peer) == " (process " + std::to_string(::getpid()) + ")");
  CHECK_FALSE(host::peer_of(-1));
  CHECK(host::process_text({}).empty());
  CHECK(host::end_text(peer) == ", end it (kill " + std::to_string(::getpid()) + ")");
  CHECK(host::end_text({}).empty());
  // Of a process that is in another container the kernel says 0.
  CHECK(host::process_text(ucred{}).empty());
  CHECK(host::end_text(ucred{}).empty());
}

}  // namespace host_local_socket_test
