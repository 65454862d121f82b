// What can stand before the '=' of --spec, and what frames of it have as their interface.
#include "cli/shared/spec_word.hpp"

#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "cli/shared/messages.hpp"
#include "tests/tool/captured.hpp"

namespace tool_shared_spec_word_test {

using namespace ocm;
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

std::string parts(const std::string& word) {
  const SpecWord parsed = parse_spec_word(word);
  return fmt::format("{}|{}|{}", parsed.interface, parsed.file, parsed.bus);
}

TEST_CASE("spec word: a file is for all interfaces, or for the one before the '='") {
  CHECK(parts("no-such-file.json") == "|no-such-file.json|");
  CHECK(parts("can0=no-such-file.json") == "can0|no-such-file.json|can0");
  CHECK(parts("can0=a=b") == "can0|a=b|can0");
  CHECK(parts("slcan:/dev/ttyACM0@500k=a.dbc") == "slcan:/dev/ttyACM0|a.dbc|slcan:/dev/ttyACM0@500k");
}

TEST_CASE("spec word: a file whose name has a '=' is one, where there is one") {
  const std::string path =
      (std::filesystem::temp_directory_path() / fmt::format("ocm-spec-word={}", ::getpid())).string();
  std::ofstream{path} << "{}";
  CHECK(parts(path) == "|" + path + "|");
  std::filesystem::remove(path);
  const auto left = test::leaving([&] { static_cast<void>(parse_spec_word(path)); });
  CHECK(left.code == exit_usage);
  CHECK_THAT(left.text, Catch::Contains(": there is no such file, and '" + path.substr(0, path.rfind('='))));
  CHECK_THAT(left.text, Catch::Contains("' cannot be an interface"));
}

TEST_CASE("spec word: both sides of the '=' have something") {
  const auto said = [](const std::string& word) {
    const auto left = test::leaving([&] { static_cast<void>(parse_spec_word(word)); });
    CHECK(left.code == exit_usage);
    return left.text;
  };
  CHECK_THAT(said("=a.dbc"), Catch::Contains("--spec =a.dbc: no interface before the '='\n          --spec "
                                             "can0=a.dbc, or --spec a.dbc for all interfaces\n"));
  CHECK_THAT(said("can0="),
             Catch::Contains("--spec can0=: no file behind the '='\n          --spec can0=FILE\n"));
}

}  // namespace tool_shared_spec_word_test
