// The header of the invented robot: big-endian fields, two of 12 bits in three bytes, names, flags, offsets.
// The bytes are worked out by hand.
#include "golden/ferry.hpp"

#include <catch2/catch.hpp>

#include "ocm/protocol/message.hpp"

namespace generator_ferry_test {

using namespace ferry;
using ocm::can::Frame;
using ocm::can::Payload;
using ocm::protocol::Priority;

TEST_CASE("two big-endian fields of 12 bits share three bytes") {
  constexpr Range range{0xABC, 0x123};
  STATIC_REQUIRE(range.encode() == Payload{0xAB, 0xC1, 0x23});
  STATIC_REQUIRE(Range::decode(Payload{0xAB, 0xC1, 0x23}) == range);
  STATIC_REQUIRE(Range::frames[0].dlc == 3);
  STATIC_REQUIRE(range.left_m() == 2.748);
  // Too far for the field is as far as it can say.
  STATIC_REQUIRE(Range{5000, 0}.encode() == Payload{0xFF, 0xF0, 0x00});
}

TEST_CASE("named values are an enumeration, flags have accessors, an offset is exact") {
  constexpr auto state = [] {
    ForkStatusState s;
    s.mode = ForkStatusState::Mode::jammed;
    s.set_loaded(true);
    s.set_bottom(true);
    s.set_temperature_celsius(21.5);
    s.set_height_mm(1234.5);
    return s;
  }();
  STATIC_REQUIRE(state.temperature == 123);
  STATIC_REQUIRE(state.temperature_celsius() == 21.5);
  STATIC_REQUIRE(state.height == 12345);
  STATIC_REQUIRE(state.loaded());
  STATIC_REQUIRE(!state.top());
  // 111 for jammed, 10001 for the flags; the height alone is little-endian.
  STATIC_REQUIRE(state.encode() == Payload{0xF1, 123, 0x39, 0x30});
  STATIC_REQUIRE(ForkStatusState::decode(state.encode()) == state);
  STATIC_REQUIRE(ForkStatusState::decode(Payload{0, 0, 0xFF, 0xFF}).height ==
                 ForkStatusState::height_unknown);
}

TEST_CASE("a falling scale and a signed big-endian field of 20 bits") {
  STATIC_REQUIRE(ForkStatusCell{-2}.encode() == Payload{0xFF, 0xFF, 0xE0});
  STATIC_REQUIRE(ForkStatusCell::decode(Payload{0xFF, 0xFF, 0xE0}).force_N() == 4.0);
  constexpr auto heavy = [] {
    ForkStatusCell c;
    c.set_force_N(-1e9);
    return c;
  }();
  STATIC_REQUIRE(heavy.force == 524'287);
}

TEST_CASE("a topic of one frame and an array of frames") {
  ForkStatus status;
  status.cell[3].force = 1;
  CHECK(status.encode(4) == Payload{0x00, 0x00, 0x10});
  CHECK(status.encode(5) == Payload{});
  std::array<Payload, 5> wire{};
  for (std::size_t i = 0; i < 5; ++i) wire[i] = status.encode(i);
  CHECK(ForkStatus::decode(wire) == status);
  CHECK(ocm::protocol::sample_frame(status, Priority::low, 4) == Frame{0x7B5, 4, {0x00, 0x00, 0x10}});
}

// Without another one, a frame has the priority of its topic: high, and urgent for the wheels.
TEST_CASE("no data, several of a kind, 64 bits") {
  STATIC_REQUIRE(ocm::protocol::sample_frame(Heartbeat{}) == Frame{0x5C0, 0, {}});
  STATIC_REQUIRE(ocm::protocol::command(Beacon{1, 2, 3}, Priority::high, 2) == Frame{0x121, 2, {0x12, 0x30}});
  constexpr auto winch = [] {
    Winch w;
    w.set_value_m(1.5);
    return w;
  }();
  STATIC_REQUIRE(winch.value == 1'500'000'000);
  STATIC_REQUIRE(ocm::protocol::command(Wheels{-1, 256}) == Frame{0x010, 4, {0xFF, 0xFF, 0x01, 0x00}});
}

TEST_CASE("the catalogue is the other robot's own") {
  STATIC_REQUIRE(catalogue.bit_rate == 250'000);
  STATIC_REQUIRE(catalogue.boards.size() == 2);
  STATIC_REQUIRE(catalogue.find("lidar") == catalogue.find("range"));
  STATIC_REQUIRE(catalogue.find("beacon_2")->group == "beacon");
  STATIC_REQUIRE(catalogue.find("fork")->frames[4].name == "cell_4");
  STATIC_REQUIRE(Lift::sensors::contains<ForkStatus>);
  const auto& right = catalogue.find("range")->frames[0].fields[1];
  CHECK(right.raw(Payload{0xAB, 0xC1, 0x23}) == 0x123);
}

}  // namespace generator_ferry_test
