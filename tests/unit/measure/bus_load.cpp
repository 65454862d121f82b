#include "ocm/measure/bus_load.hpp"

#include <chrono>
#include <random>

#include <catch2/catch.hpp>

#include "ocm/can/text.hpp"

namespace measure_bus_load_test {

using namespace std::chrono_literals;
using namespace ocm::measure;
using ocm::base::Time;
using ocm::can::Frame;

TEST_CASE("bus_load: a frame takes its stuff bits and the intermission") {
  // 44 bits of frame, 32 of data, 5 stuff bits: tests/unit/can/length.cpp.
  STATIC_REQUIRE(bits_on_bus(Frame{0x205, 4, {0x01, 0x84, 0x03, 0x02}}) == 44 + 32 + 5 + 3);
}

TEST_CASE("bus_load: of CAN FD the bits behind the switch go at their own rate") {
  using ocm::can::AnyFrame;
  namespace flag = ocm::can::frame_flag;
  constexpr AnyFrame classic{Frame{0x205, 4, {0x01, 0x84, 0x03, 0x02}}};
  STATIC_REQUIRE(bits_on_bus(classic, {500'000}) == 84U);
  AnyFrame frame;
  frame.id = 0x123;
  frame.length = 64;
  frame.data.fill(0x55);
  frame.flags = flag::fd;
  const auto whole = ocm::can::fd_frame_bits(frame);
  CHECK(bits_on_bus(frame, {500'000}) == whole.nominal + 3);
  frame.flags |= flag::bit_rate_switch;
  const auto bits = ocm::can::fd_frame_bits(frame);
  REQUIRE(bits.data > 500);
  CHECK_FALSE(bits_on_bus(frame, {500'000}).has_value());
  CHECK(bits_on_bus(frame, {500'000, 500'000}) == bits.nominal + 3 + bits.data);
  CHECK(bits_on_bus(frame, {500'000, 1'000'000}) == bits.nominal + 3 + (bits.data + 1) / 2);
}

TEST_CASE("bus_load: the tables count as the bits do") {
  std::mt19937 random{9};
  using ocm::can::Format;
  for (int i = 0; i < 100'000; ++i) {
    Frame frame;
    frame.format = static_cast<Format>(random() % 4);
    // Half of the time runs of one level, which are what is stuffed.
    const auto number = [&]() -> std::uint32_t {
      const auto any = static_cast<std::uint32_t>(random());
      return random() % 2 == 0 ? any : ~0U << any % 32;
    };
    frame.id = number() & (ocm::can::is_extended(frame.format) ? 0x1FFF'FFFFU : 0x7FFU);
    frame.dlc = static_cast<std::uint8_t>(random() % 9);
    for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(number());
    if (bits_on_bus(frame) != ocm::can::frame_bits(frame) + 3) {
      CAPTURE(ocm::can::to_text(frame).view());
      REQUIRE(bits_on_bus(frame) == ocm::can::frame_bits(frame) + 3);
    }
  }
}

TEST_CASE("bus_load: the worst window is found wherever it begins") {
  BusLoad load;
  for (int ms = 0; ms < 1000; ms += 10) load.add(Time{ms * 1ms}, 100);  // ten a window
  CHECK(load.worst_bits() == 1000);
  // A burst of 50 frames from 1055 to 1104 ms: a window of fixed borders would cut it at 1100.
  for (int ms = 1055; ms < 1105; ++ms) load.add(Time{ms * 1ms}, 100);
  CHECK(load.worst_bits() == 5000);
  CHECK(load.worst_until() == Time{1104ms});
  load.add(Time{5s}, 100);
  CHECK(load.worst_bits() == 5000);
  CHECK(load.worst_until() == Time{1104ms});
}

TEST_CASE("bus_load: of windows that are as bad the first is named") {
  BusLoad load;
  CHECK(load.worst_bits() == 0);
  CHECK(load.worst_until() == Time{});
  for (const auto time : {1s, 2s, 3s}) load.add(Time{time}, 100);
  CHECK(load.worst_until() == Time{1s});
  load.add(Time{4s}, 101);
  CHECK(load.worst_until() == Time{4s});
  CHECK(BitRates{}.nominal + BitRates{}.data == 0);
}

TEST_CASE("bus_load: what is a window old is out of it") {
  BusLoad load;
  load.add(Time{0ms}, 7);
  load.add(Time{99ms}, 7);
  CHECK(load.worst_bits() == 14);
  load.add(Time{199ms}, 8);
  CHECK(load.worst_bits() == 14);
  load.add(Time{298ms}, 7);
  CHECK(load.worst_bits() == 15);
}

TEST_CASE("bus_load: what came before a pause is in no window behind it") {
  BusLoad load;
  load.add(Time{50ms}, 5);
  load.add(Time{1s}, 7);
  load.add(Time{1060ms}, 7);
  CHECK(load.worst_bits() == 14);
}

TEST_CASE("bus_load: times that go back, a little and a lot, and before 1970") {
  BusLoad load;
  load.add(Time{-1ms}, 5);
  load.add(Time{-2ms}, 5);
  CHECK(load.worst_bits() == 10);
  load.add(Time{-10s}, 20);  // a window of its own
  CHECK(load.worst_bits() == 20);
  CHECK(load.worst_until() == Time{-10s});
  load.add(Time{Time::max() - Time{}}, 21);
  CHECK(load.worst_bits() == 21);
  BusLoad early;
  early.add(Time{-60ms}, 5);
  early.add(Time{-120ms}, 5);  // within the window of the first frame, not of 1970
  CHECK(early.worst_bits() == 10);
  BusLoad back;
  back.add(Time{100ms}, 5);
  back.add(Time{0ms}, 7);  // just out of the window
  CHECK(back.worst_bits() == 7);
}

TEST_CASE("bus_load: a share of time") {
  STATIC_REQUIRE(share(500, 1ms, 1'000'000) == 0.5);
  STATIC_REQUIRE(share(50'000, 100ms, 500'000) == 1.0);
  STATIC_REQUIRE(share(100, 0ms, 500'000) == 0.0);
  STATIC_REQUIRE(share(1, 1ns, 1'000'000'000) == 1.0);
}

}  // namespace measure_bus_load_test
