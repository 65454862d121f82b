// A board that also hears what is not for it: FIFO 1, and never instead of FIFO 0.
#include <cstdint>
#include <optional>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/can/frame.hpp"
#include "ocm/topics/amiro.hpp"

#include "firmware/drivers/bxcan.hpp"
#include "firmware/drivers/bxcan_filter.hpp"
#include "tests/firmware/bxcan/bench.hpp"

namespace ocm::bxcan_tests {

namespace {

constexpr auto wide = bxcan::wide_filter_banks_of<amiro::DiWheelDrive>();
constexpr auto narrow = bxcan::filter_banks_of<amiro::DiWheelDrive>();

struct Overhearing {
  Model model;
  bxcan::Bxcan<ModelRegisters> can{ModelRegisters{model}};
  explicit Overhearing(const bxcan::FilterBanks& banks = wide) {
    REQUIRE(can.start(timing, banks).ok());
    for (int i = 0; i < 4; ++i) static_cast<void>(model.read(Register::msr));
    REQUIRE_FALSE(model.initialising());
  }
};

/// Every identifier of 11 bits in both formats, and some of 29.
template <class F>
void each_frame(F use) {
  for (std::uint32_t id = 0; id <= can::max_base_id; ++id) {
    use(can::Frame{id, 1, {0x5A}});
    use(can::Frame{id, 2, {}, can::Format::base_remote});
    use(can::Frame{id << 18 | 0x2'AAAA, 1, {0x5A}, can::Format::extended});
    use(can::Frame{id << 18, 8, {}, can::Format::extended_remote});
  }
}

}  // namespace

TEST_CASE("overhear: wide filters let the same through as narrow ones, and software agrees with both") {
  Overhearing one{wide};
  Overhearing other{narrow};
  unsigned wrong = 0;
  unsigned heard = 0;
  each_frame([&](const can::Frame& frame) {
    const bool accepted = one.model.deliver(frame);
    heard += accepted;
    wrong += accepted != other.model.deliver(frame);
    wrong += accepted != wide.accepts(frame);
    wrong += accepted != narrow.accepts(frame);
    while (one.can.receive()) {
    }
    while (other.can.receive()) {
    }
  });
  CHECK(wrong == 0);
  CHECK(heard > 0);
  CHECK(one.model.violations.empty());
}

TEST_CASE("overhear: all that is not for the board comes in FIFO 1, as it was; what is for it, in FIFO 0") {
  Overhearing bench;
  REQUIRE(bench.can.overhear(true));
  unsigned wrong = 0;
  each_frame([&](const can::Frame& frame) {
    wrong += !bench.model.deliver(frame);
    const bool mine = wide.accepts(frame);
    wrong += bench.model.receive_interrupt() != mine;
    wrong += bench.model.receive_interrupt_of_fifo_1() == mine;
    const auto own = bench.can.receive();
    const auto others = bench.can.overheard();
    wrong += own.has_value() != mine || others.has_value() == mine;
    wrong += (mine ? own : others) != std::optional{frame};
  });
  CHECK(wrong == 0);
  CHECK(bench.model.violations.empty());
}

TEST_CASE("overhear: off, the controller is as before; on and off loses no frame of the board") {
  Overhearing bench;
  CHECK_FALSE(bench.model.deliver({0x6A0, 1, {}}));
  unsigned accesses = 0;
  unsigned accepted = 0;
  bench.model.on_access = [&] {  // between any two accesses
    ++accesses;
    accepted += bench.model.deliver({0x208, 0, {}});
  };
  for (int i = 0; i < 20; ++i) REQUIRE(bench.can.overhear(i % 2 == 0));
  bench.model.on_access = nullptr;
  CHECK(accesses >= 40);
  CHECK(accepted == accesses);
  while (bench.can.receive()) {
  }
  CHECK_FALSE(bench.model.deliver({0x6A0, 1, {}}));
  CHECK(bench.model.violations.empty());
}

TEST_CASE("overhear: what is left in FIFO 1 is not for the next time, and a lost frame is counted") {
  Overhearing bench;
  REQUIRE(bench.can.overhear(true));
  for (std::uint8_t i = 0; i < 5; ++i) REQUIRE(bench.model.deliver({0x6A0, 1, {i}}));
  REQUIRE(bench.model.deliver({0x208, 1, {9}}));  // has its own places
  std::vector<std::uint8_t> serials;
  while (const auto frame = bench.can.overheard()) serials.push_back(frame->data[0]);
  CHECK(serials == std::vector<std::uint8_t>{0, 1, 4});
  CHECK(bench.can.counters().overheard == 3);
  CHECK(bench.can.counters().overheard_lost == 1);
  CHECK(bench.can.counters().overruns == 0);
  CHECK(bench.can.receive()->data[0] == 9);

  for (std::uint8_t i = 0; i < 3; ++i) REQUIRE(bench.model.deliver({0x6A0, 1, {i}}));
  REQUIRE(bench.can.overhear(false));
  CHECK_FALSE(bench.model.receive_interrupt_of_fifo_1());
  REQUIRE(bench.can.overhear(true));
  CHECK_FALSE(bench.can.overheard());
  CHECK(bench.model.violations.empty());
}

TEST_CASE("overhear: not with narrow filters, where the manual does not say which FIFO gets a frame") {
  Overhearing bench{narrow};
  CHECK_FALSE(bench.can.overhear(true));
  CHECK_FALSE(bench.model.deliver({0x6A0, 1, {}}));
  CHECK(bench.model.deliver({0x208, 1, {}}));
}

TEST_CASE("overhear: the model finds filters of one kind that lead one frame into both FIFOs") {
  Model model;
  const auto set = [&model](Register which, std::uint32_t value) { model.write(which, value); };
  set(Register::mcr, bxcan::mcr::inrq);
  for (int i = 0; i < 4; ++i) static_cast<void>(model.read(Register::msr));
  set(Register::ffa1r, 2);
  set(Register::fa1r, 3);  // two masks that let all through
  set(Register::fmr, 0);
  set(Register::mcr, 0);
  for (int i = 0; i < 4; ++i) static_cast<void>(model.read(Register::msr));
  model.deliver({0x123, 0, {}});
  REQUIRE(model.violations.size() == 1);
  CHECK(model.violations[0] == "it is not said which FIFO gets this frame");
}

}  // namespace ocm::bxcan_tests
