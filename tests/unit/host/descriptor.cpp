#include "ocm/host/descriptor.hpp"

#include <fcntl.h>
#include <type_traits>
#include <utility>

#include <catch2/catch.hpp>

namespace host_descriptor_test {

using ocm::host::Descriptor;

static_assert(!std::is_copy_constructible_v<Descriptor>);
static_assert(std::is_nothrow_move_constructible_v<Descriptor>);

Descriptor open_null() {
  return Descriptor{::open("/dev/null", O_RDONLY | O_CLOEXEC)};
}
bool is_open(int number) {
  return ::fcntl(number, F_GETFD) != -1;
}

TEST_CASE("a descriptor is closed with its owner") {
  int number = -1;
  {
    const Descriptor descriptor = open_null();
    REQUIRE(descriptor);
    number = descriptor.get();
    CHECK(is_open(number));
  }
  CHECK_FALSE(is_open(number));
}

TEST_CASE("moving hands it over, and closes what stood there") {
  Descriptor first = open_null();
  Descriptor second = open_null();
  const int kept = first.get();
  const int closed = second.get();
  second = std::move(first);
  CHECK(second.get() == kept);
  CHECK(is_open(kept));
  CHECK_FALSE(is_open(closed));
  CHECK_FALSE(first);  // NOLINT: a moved-from descriptor is none
}

TEST_CASE("none is none") {
  Descriptor none{::open("/no/such/file", O_RDONLY)};
  CHECK_FALSE(none);
  none.reset();
  CHECK_FALSE(none);
}

}  // namespace host_descriptor_test
