// What can stand before the '=' of --spec, and what frames of it have as their interface.
#include "cli/shared/spec_word.hpp"

#include <string>

#include <catch2/catch.hpp>

namespace tool_shared_spec_word_test {

using namespace ocm::cli;

TEST_CASE("spec word: the name of a network device has 1 to 15 bytes, without blanks, '/' and ':'") {
  for (const char* const name : {"can0", "c", "a_name_of_15_le", ".x", "..x", "sim0"}) {
    CAPTURE(name);
    CHECK(can_be_interface(name));
  }
  for (const char* const name :
       {"", "a_name_of_16_let", ".", "..", "a/b", "a:b", "a b", "a\tb", "a\nb", "a\vb", "a\fb", "a\rb"}) {
    CAPTURE(name);
    CHECK_FALSE(can_be_interface(name));
  }
}

TEST_CASE("spec word: so has each other bus that --bus takes, however long it is") {
  for (const char* const name :
       {"sim", "sim:/run/user/1000/another one", "slcan:/dev/ttyACM0@500k", "slcan:x"}) {
    CAPTURE(name);
    CHECK(can_be_interface(name));
  }
  CHECK_FALSE(can_be_interface("slcan:"));  // of no adapter
}

TEST_CASE("spec word: frames of an adapter have its device as their interface, whatever its rates") {
  CHECK(interface_of("slcan:/dev/ttyACM0@500k") == "slcan:/dev/ttyACM0");
  CHECK(interface_of("slcan:/dev/ttyACM0") == "slcan:/dev/ttyACM0");
  CHECK(interface_of("slcan:/dev/a@b@500k") == "slcan:/dev/a@b");
  CHECK(interface_of("sim:/tmp/a@b") == "sim:/tmp/a@b");
  CHECK(interface_of("can0") == "can0");
}

}  // namespace tool_shared_spec_word_test
