// The header of a spec whose topics have floating-point numbers. The bytes are worked out by hand [IEEE 754].
#include <cmath>
#include <limits>

#include <catch2/catch.hpp>

#include "ocm/protocol/message.hpp"

#include "generator/spec/spec.hpp"
#include "golden/probe.hpp"

namespace generator_floats_test {

using namespace probe;
using ocm::can::Payload;
namespace protocol = ocm::protocol;

TEST_CASE("floats: a member is the number, and its bits travel, in both byte orders") {
  constexpr Depth depth{1.5F, -2.0F};
  STATIC_REQUIRE(depth.encode() == Payload{0x00, 0x00, 0xC0, 0x3F, 0xC0, 0x00, 0x00, 0x00});
  STATIC_REQUIRE(Depth::decode(depth.encode()) == depth);
  STATIC_REQUIRE(depth.depth_m() == 1.5);
  constexpr PositionEast east{1.0};
  STATIC_REQUIRE(east.encode() == Payload{0x3F, 0xF0});
  STATIC_REQUIRE(PositionEast::decode(Payload{0xC0, 0x00}).value == -2.0);
  // 0x3F800000 from bit 3 on, behind a bit that is a name.
  constexpr PositionCell cell{PositionCell::Valid::yes, 1.0F, -1};
  STATIC_REQUIRE(cell.encode() == Payload{0x01, 0x00, 0x00, 0xFC, 0x01, 0xFF, 0xFF, 0xFF});
  STATIC_REQUIRE(PositionCell::decode(cell.encode()) == cell);
}

TEST_CASE("floats: scale, offset and range are those of the physical value") {
  constexpr PositionEast east{30.0};
  STATIC_REQUIRE(east.value_deg() == 5.0);
  constexpr auto set = [](double force) {
    Thrust thrust;
    thrust.set_force_N(force);
    return thrust.force;
  };
  STATIC_REQUIRE(set(39.5) == 39.5F);
  STATIC_REQUIRE(set(1e30) == 40.0F);
  STATIC_REQUIRE(set(-3) == -2.5F);
  STATIC_REQUIRE(set(std::numeric_limits<double>::quiet_NaN()) == 0.0F);
  STATIC_REQUIRE(set(std::numeric_limits<double>::infinity()) == 40.0F);
  STATIC_REQUIRE(protocol::within(std::numeric_limits<double>::quiet_NaN(), 1, 2) == 1);
  STATIC_REQUIRE(protocol::within(std::numeric_limits<double>::quiet_NaN(), -2, -1) == -1);
  Depth depth;
  depth.set_depth_m(std::numeric_limits<double>::quiet_NaN());
  CHECK(std::isnan(Depth::decode(depth.encode()).depth_m()));
}

TEST_CASE("floats: the wire's hash tells them from integers of the same bits") {
  const auto hash = [](const char* type) {
    const auto loaded = ocm::spec::parse(
        std::string{R"({"robot": "r", "namespace": "r", "bus": {"bit_rate": 500000, "source": "s"},
          "boards": [{"name": "b", "mcu": "m", "source": "s"}],
          "topics": [{"name": "t", "id": "0x10", "board": "b", "period": "1s", "source": "s",
                      "frames": [{"fields": [{"name": "x", "byte": 0, "type": ")"} +
            type + R"("}]}]}]})",
        "r.json");
    REQUIRE(loaded.spec != nullptr);
    return protocol::wire_hash(loaded.spec->catalogue());
  };
  CHECK(hash("u32") != hash("f32"));
  CHECK(hash("i32") != hash("f32"));
  CHECK(hash("i64") != hash("f64"));
}

}  // namespace generator_floats_test
