#include "cli/serve/fleet_order.hpp"

#include <string>

#include <catch2/catch.hpp>

namespace serve_fleet_order_test {

using ocm::cli::serve::fleet_order_of;
using Kind = ocm::cli::serve::FleetOrder::Kind;

TEST_CASE("fleet order: a place, or a word") {
  const auto go = fleet_order_of(R"({"robot":"AVR","x_m":1.25,"y_m":-0.5})");
  REQUIRE(go);
  CHECK(go->kind == Kind::go);
  CHECK(go->robot == "AVR");
  CHECK(go->place == ocm::motion::Point{1.25F, -0.5F});
  CHECK(fleet_order_of(R"({"robot":3,"x_m":1e1,"y_m":0})")->robot == "3");
  CHECK(fleet_order_of(R"({"robot":"A","x_m":1e1,"y_m":0})")->place.x_m == 10);
  CHECK(fleet_order_of(R"({"robot":"A","order":"stop"})")->kind == Kind::stop);
  CHECK(fleet_order_of(R"({"robot":"A","order":"pause"})")->kind == Kind::pause);
  CHECK(fleet_order_of(R"({"robot":"A","order":"go_on"})")->kind == Kind::go_on);
  CHECK(fleet_order_of(R"({"robot":"A","order":"call_back"})")->kind == Kind::call_back);
  CHECK(fleet_order_of(R"({"order":"look"})")->kind == Kind::look);
}

TEST_CASE("fleet order: what is none says what would be one") {
  for (const char* payload :
       {"", "[]", "3", R"({})", R"({"robot":"A"})", R"({"robot":"A","x_m":1})", R"({"robot":"A","y_m":1})",
        R"({"robot":"A","x_m":1,"order":"stop"})", R"({"robot":"A","x_m":1,"y_m":1,"order":"stop"})",
        R"({"robot":"A","x_m":"1","y_m":1})", R"({"robot":"A","x_m":1001,"y_m":1})",
        R"({"robot":"A","x_m":1e99,"y_m":1})", R"({"robot":"A","order":"Stop"})",
        R"({"robot":"A","order":1})", R"({"robot":true,"order":"stop"})", R"({"order":"stop"})",
        R"({"robot":"","order":"stop"})", R"({"robot":"A","order":"stop","speed":3})", "{\"robot\":\"A\""}) {
    CAPTURE(payload);
    const auto order = fleet_order_of(payload);
    REQUIRE_FALSE(order);
    CHECK(order.error.size() > 10);
  }
  CHECK(fleet_order_of(R"({"robot":"A","order":"fly"})").error.find("unknown order 'fly'") == 0);
  CHECK(fleet_order_of(R"({"robot":"A","order":""})").error.find("unknown order ''") == 0);
  CHECK(fleet_order_of(R"({"robot":"A","order":"go"})").error.find("unknown order 'go'") == 0);
  CHECK(fleet_order_of(R"({"robot":"A","x_m":1001,"y_m":1})").error.find("x_m '1001'") == 0);
}

TEST_CASE("fleet order: how far a place may be") {
  for (const char* const far : {"1000", "-1000"}) {
    INFO(far);
    CHECK(fleet_order_of(std::string{R"({"robot":"A","x_m":0,"y_m":)"} + far + "}"));
  }
  for (const char* const far : {"1000.5", "-1000.5"}) {
    INFO(far);
    CHECK(fleet_order_of(std::string{R"({"robot":"A","x_m":0,"y_m":)"} + far + "}").error ==
          std::string{"y_m '"} + far + "' is no place: expected metres, -1000 to 1000");
  }
}

}  // namespace serve_fleet_order_test
