// Names of buses, and where the operator of each is found.
#include "cli/shared/buses.hpp"

#include <catch2/catch.hpp>

#include "cli/shared/operator_link.hpp"

namespace tool_clock_buses_test {

using namespace ocm::cli;
using Kind = BusName::Kind;

TEST_CASE("buses: an interface, a serial adapter and the simulator by their names") {
  struct Row {
    const char* name;
    Kind kind;
    const char* address;
  };
  for (const Row& row : {Row{"can0", Kind::interface, "can0"}, Row{"sim", Kind::simulated, ""},
                         Row{"sim:/tmp/x", Kind::simulated, "/tmp/x"}, Row{"sim0", Kind::interface, "sim0"},
                         Row{"slcan:/dev/ttyACM0@500k", Kind::serial, "/dev/ttyACM0@500k"},
                         Row{"slcan", Kind::interface, "slcan"}}) {
    CAPTURE(row.name);
    CHECK(parse_bus_name(row.name).kind == row.kind);
    CHECK(parse_bus_name(row.name).address == row.address);
  }
}

TEST_CASE("buses: an operator is found by its bus, whatever the rate of an adapter, or the way to its path") {
  CHECK_THAT(operator_path("can0"), Catch::EndsWith("/operator-can0.sock"));
  CHECK_THAT(operator_path("sim"), Catch::EndsWith("/operator-sim.sock"));
  CHECK_THAT(operator_path("sim:/tmp/a"), Catch::Contains("/operator-sim-"));
  CHECK(operator_path("sim:/tmp/a") != operator_path("sim:/tmp/b"));
  CHECK(operator_path("sim:/tmp/a") == operator_path("sim:/tmp/../tmp/a"));
  CHECK_THAT(operator_path("slcan:/dev/a_line"), Catch::Contains("/operator-slcan-"));
  CHECK(operator_path("slcan:/dev/a_line@500k") == operator_path("slcan:/dev/a_line"));
  CHECK(operator_path("slcan:/dev/a_line@500k") == operator_path("slcan:/dev/a_line@1M"));
  CHECK(operator_path("slcan:/dev/a_line") != operator_path("slcan:/dev/b_line"));
}

}  // namespace tool_clock_buses_test
