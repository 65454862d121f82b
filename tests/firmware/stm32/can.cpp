#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/can/bit_timing.hpp"
#include "ocm/topics/amiro.hpp"

#include "firmware/chibios/stm32/can_bus.hpp"
#include "firmware/stm32/fixture.hpp"
#include "sim/parts/bxcan_model.hpp"

namespace firmware_stm32_can_test {

using namespace ocm::stm32_tests;
using namespace ocm::firmware::chibios;
using namespace std::chrono_literals;
using ocm::can::Frame;
namespace bxcan = ocm::firmware::drivers::bxcan;
using Model = ocm::sim::BxcanModel;

constexpr auto timing = stm32::bit_timing<amiro::DiWheelDrive, 500'000>;
static_assert(timing.exact(36'000'000));
constexpr auto filters = bxcan::filter_banks_of<amiro::DiWheelDrive>();
// [RM0008 table 63, RM0090 table 62]
constexpr std::uint32_t transmitted = 19, received = 20, status_changed = 22;

/// A bus at the address of the chip's controller.
struct Bench : private PlayedRegisters {
  Chip played;
  Model model;
  Attached attached{stm32::can1_address, *this};
  Port port;
  stm32::CanBus bus;

  Bench() {
    REQUIRE(bus.start(port, timing, filters).ok());
    for (int i = 0; i < 4; ++i) static_cast<void>(model.read(bxcan::Register::msr));  // it joins
    REQUIRE(!model.initialising());
    played.calls.clear();
  }
  std::uint32_t read(std::uint32_t offset) override {
    return model.read(static_cast<bxcan::Register>(offset));
  }
  void write(std::uint32_t offset, std::uint32_t value) override {
    model.write(static_cast<bxcan::Register>(offset), value);
  }

  /// What the one thread hears next; none: it waits on.
  std::optional<BusEvent> next(Frame& frame) {
    std::optional<BusEvent> event;
    played.waits_left = 3;
    static_cast<void>(ends([&] { event = bus.wait(frame); }));
    return event;
  }
  std::optional<BusEvent> next() {
    Frame frame;
    return next(frame);
  }
  /// One of the frames that wait goes out.
  void transmit() {
    REQUIRE(model.begin());
    model.end(Model::End::acknowledged);
    while (model.transmit_interrupt()) Vector8C();
  }
  void fill() {
    std::uint8_t number = 0;
    for (auto taken = bus.send({0x600, 1, {number}}); *taken; taken = bus.send({0x600, 1, {++number}}))
      REQUIRE(taken.ok());
  }
};

TEST_CASE(
    "CAN: it starts with a controller that was reset, and its interrupts are below the kernel's timer") {
  Bench bench;
  CHECK((RCC->APB1ENR & RCC_APB1ENR_CAN1EN) != 0);
  CHECK(bench.played.resets == 1);
  for (const std::uint32_t interrupt : {transmitted, received, status_changed}) {
    CHECK(bench.played.enabled(interrupt));
    CHECK(bench.played.priorities[interrupt] == 11);
  }
  CHECK(bench.model.violations.empty());
}

TEST_CASE("CAN: a controller that does not answer is an error, and no interrupt is let through") {
  Chip played;
  struct : PlayedRegisters {
    std::uint32_t read(std::uint32_t) override { return 0; }
    void write(std::uint32_t, std::uint32_t) override {}
  } silent;
  const Attached attached{stm32::can1_address, silent};
  Port port;
  stm32::CanBus bus;
  CHECK(bus.start(port, timing, filters).error == ocm::base::Error::timed_out);
  CHECK(!played.enabled(transmitted));
  CHECK(!played.enabled(received));
  CHECK(!played.enabled(status_changed));
}

TEST_CASE("CAN: what is for the board is heard, in the order in which it came") {
  Bench bench;
  CHECK(bench.next() == std::nullopt);
  std::vector<Frame> sent;
  for (std::uint32_t id = 0; id < 0x800 && sent.size() < 3; ++id) {
    const Frame frame{id, 2, {static_cast<std::uint8_t>(sent.size()), 7}};
    if (!bench.model.deliver(frame)) continue;
    sent.push_back(frame);
    Vector90();
  }
  REQUIRE(sent.size() == 3);
  for (const Frame& frame : sent) {
    Frame heard;
    REQUIRE(bench.next(heard) == BusEvent::frame);
    CHECK(heard == frame);
  }
  CHECK(bench.next() == std::nullopt);
  CHECK(bench.bus.counters().received == 3);
  CHECK(bench.bus.missed() == 0);
}

TEST_CASE("CAN: room is announced to who was refused, once, and to no other") {
  Bench bench;
  REQUIRE(*bench.bus.send({0x600, 0, {}}));
  bench.transmit();
  CHECK(bench.next() == std::nullopt);
  bench.fill();
  CHECK(bench.next() == std::nullopt);  // nothing has left yet
  bench.transmit();
  CHECK(bench.next() == BusEvent::writable);
  bench.transmit();
  CHECK(bench.next() == std::nullopt);
  CHECK(bench.bus.counters().sent == 3);
}

TEST_CASE("CAN: a lost bus is announced once, before frames, and what was given up makes room") {
  Bench bench;
  bench.fill();
  for (int i = 0; i < 40 && bench.model.begin(); ++i) bench.model.end(Model::End::bit_error);
  REQUIRE(bench.model.error_interrupt());
  Vector98();
  CHECK(bench.next() == BusEvent::lost);
  CHECK(bench.next() == BusEvent::writable);
  CHECK(bench.next() == std::nullopt);
  CHECK(bench.bus.errors().state == bxcan::BusState::off);
  CHECK(bench.bus.counters().bus_off == 1);
}

TEST_CASE("CAN: a bus on which no node answers is found lost by who waits, without an interrupt") {
  Bench bench;
  REQUIRE(*bench.bus.send({0x600, 0, {}}));
  for (int i = 0; i < 20 && bench.model.begin(); ++i) bench.model.end(Model::End::no_acknowledge);
  std::optional<BusEvent> event;
  const auto since = bench.played.now;
  bench.played.waits_left = 1000;
  Frame frame;
  static_cast<void>(ends([&] { event = bench.bus.wait(frame); }));
  CHECK(event == BusEvent::lost);
  CHECK(bench.played.now - since == bxcan::silence_limit + 10ms);  // the first look says since when
}

}  // namespace firmware_stm32_can_test
