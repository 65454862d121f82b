#include "ocm/analysis/bus_check.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/can/length.hpp"
#include "ocm/topics/amiro.hpp"

namespace analysis_bus_check_test {

using namespace ocm::analysis;
using ocm::can::Format;
using ocm::can::worst_frame_bits;

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t us = 1'000;
constexpr CanBus amiro_bus{.bit = 2'000};  // 500 kbit/s

/// A set with everything that the robot's sensors send, but its ring, every 50 ms, and the ring asked for.
/// At generic lengths, as in the literature: 17 frames, 1635 bits.
constexpr auto busy_robot(bool exact_lengths, std::uint32_t ring_level) {
  BusCheck<32> check{amiro_bus};
  const auto each = [&](auto topic, std::uint32_t level, bool asked) {
    using Topic = decltype(topic);
    for (const auto& frame : Topic::frames) {
      const auto bits = exact_lengths
                            ? ocm::protocol::worst_bits(frame, static_cast<ocm::protocol::Priority>(level))
                            : worst_frame_bits(Format::base, frame.dlc);
      const Message message{.cost = bits_ns(bits, 500'000),
                            .period = 50 * ms,
                            .deadline = Topic::deadline.count(),
                            .key = level << 8 | frame.id.value};
      static_cast<void>(asked ? check.asks(message) : check.runs(message));
    }
  };
  each(amiro::Odometry{}, 2, false);
  each(amiro::FloorProximity{}, 2, false);
  each(amiro::Magnetometer{}, 2, false);
  each(amiro::Gyroscope{}, 2, false);
  each(amiro::Accelerometer{}, 2, false);
  each(amiro::PowerStatus{}, 2, false);
  each(amiro::ProximityRing{}, ring_level, true);
  return check;
}

// The ring every millisecond asks for 8 x 75 of 500 bits; from the blocking of one frame of 8 bytes (270 us)
// and its own eight (8 x 150 us) on it fits.
constexpr bool generic_lengths = [] {
  auto check = busy_robot(false, 0);
  const Decision refused = check.decide(1 * ms);
  return !refused.admitted && check.messages()[refused.late].key == 0x23 &&
         refused.why.reason == Reason::misses_deadline && refused.why.response == (135 + 5 * 75) * 2 * us &&
         check.decide(1'500 * us).admitted && check.decide(1'470 * us).admitted &&
         !check.decide(1'469 * us).admitted;
}();
static_assert(generic_lengths);

TEST_CASE("The shortest period that passes does, and the one before it does not") {
  for (const bool exact : {false, true}) {
    for (const std::uint32_t level : {0U, 1U, 2U, 3U}) {
      auto check = std::make_unique<BusCheck<32>>(busy_robot(exact, level));
      REQUIRE_FALSE(check->decide(1 * ms).admitted);
      const std::int64_t found = check->shortest(1 * ms, us, 65'535 * us);
      INFO(exact << ' ' << level << ' ' << found);
      REQUIRE(found > 1 * ms);
      CHECK(check->decide(found).admitted);
      CHECK_FALSE(check->decide(found - us).admitted);
      // The limit itself is a period that may be found.
      CHECK(check->shortest(1 * ms, us, found) == found);
      CHECK(check->shortest(1 * ms, us, found - us) == 0);
      // A brute search finds none before it.
      for (std::int64_t period = 1 * ms; period < found; period += 7 * us)
        REQUIRE_FALSE(check->decide(period).admitted);
    }
  }
}

TEST_CASE("What is late already is not held against the newcomer") {
  BusCheck<4> check{{.bit = 1}};
  CHECK(check.runs({.cost = 100, .period = 1'000, .deadline = 50, .key = 5}).ok());
  CHECK(check.asks({.cost = 10, .period = 1, .key = 9}).ok());
  CHECK(check.decide(1'000).admitted);
  // Who is in time now, and would not be any more, is.
  BusCheck<4> other{{.bit = 1}};
  CHECK(other.runs({.cost = 100, .period = 1'000, .deadline = 105, .key = 5}).ok());
  CHECK(other.asks({.cost = 10, .period = 1, .key = 9}).ok());
  const Decision decision = other.decide(1'000);
  REQUIRE_FALSE(decision.admitted);
  CHECK(other.messages()[decision.late].key == 5);
  CHECK(decision.why.slack() == -5);
  CHECK(other.shortest(1'000, 1, 1'000'000) == 0);  // one frame is too much, however seldom
}

TEST_CASE("A frame must be gone before the next one, or by its deadline if that is earlier") {
  BusCheck<4> check{{.bit = 1}};
  CHECK(check.asks({.cost = 10, .deadline = 1'000, .key = 1}).ok());
  CHECK(check.asks({.cost = 10, .deadline = 1'000, .key = 2}).ok());
  CHECK(check.decide(20).admitted);  // each waits for one of the other
  CHECK(check.decide(19).late == 0);
}

TEST_CASE("A request takes the place of the stream that it changes") {
  BusCheck<4> check{{.bit = 1}};
  CHECK(check.runs({.cost = 60, .period = 100, .key = 1}).ok());
  CHECK(check.asks({.cost = 60, .key = 1}).ok());
  CHECK(check.decide(100).admitted);
  CHECK(check.messages().size() == 1);
  CHECK(check.is_asked(1));
  CHECK_FALSE(check.is_asked(2));
}

TEST_CASE("Of one key the more frequent counts") {
  BusCheck<4> check{{.bit = 1}};
  CHECK(check.runs({.cost = 10, .period = 100, .key = 1}).ok());
  CHECK(check.runs({.cost = 10, .period = 20, .key = 1}).ok());
  CHECK(check.runs({.cost = 10, .period = 50, .key = 1}).ok());
  CHECK(check.asks({.cost = 10, .key = 2}).ok());
  CHECK(check.decide(100).admitted);
  CHECK(check.messages()[0].period == 20);
  // Of two that are as frequent, the first.
  CHECK(check.runs({.cost = 12, .period = 20, .key = 1}).ok());
  CHECK(check.decide(100).admitted);
  CHECK(check.messages()[0].cost == 10);
}

TEST_CASE("A set that is too large, and numbers that mean nothing, are refused") {
  BusCheck<2> check{{.bit = 1}};
  CHECK(check.runs({.cost = 1, .period = 100, .key = 1}).ok());
  CHECK(check.runs({.cost = 1, .period = 100, .key = 2}).ok());
  CHECK(check.runs({.cost = 1, .period = 100, .key = 3}).error == ocm::base::Error::full);
  CHECK(check.asks({.cost = 1, .key = 3}).ok());
  CHECK_FALSE(check.decide(100).admitted);
  CHECK(check.decide(100).late == no_index);
  check.clear();
  CHECK(check.asks({.cost = 1, .key = 3}).ok());
  CHECK(check.decide(100).admitted);
  CHECK(check.decide(1).admitted);  // all of the bus
  CHECK_FALSE(check.decide(0).admitted);
  CHECK_FALSE(check.decide(-5).admitted);
}

TEST_CASE("What is admitted meets its deadlines by the exact analysis, and nothing more is refused") {
  std::mt19937 random{4};
  const auto between = [&](std::int64_t low, std::int64_t high) {
    return std::uniform_int_distribution<std::int64_t>{low, high}(random);
  };
  int admitted = 0;
  for (int round = 0; round < 2'000; ++round) {
    BusCheck<8> check{{.bit = 1}};
    std::array<Message, 6> set{};
    const auto period = between(300, 2'000);
    for (std::size_t i = 0; i < set.size(); ++i) {
      set[i] = {.cost = between(50, 135),
                .period = between(400, 4'000),
                .deadline = between(300, 3'000),
                .key = static_cast<std::uint32_t>(i)};
      if (i == 2 || i == 4) set[i].period = period;
      CHECK((i == 2 || i == 4 ? check.asks(set[i]) : check.runs(set[i])).ok());
      set[i].deadline = std::min(set[i].deadline, set[i].period);
    }
    const auto after = can_response_times(set);
    std::array<Message, 4> rest{set[0], set[1], set[3], set[5]};
    const auto before = can_response_times(rest);
    constexpr std::array<std::size_t, 6> place{0, 1, 9, 2, 9, 3};
    bool expected = true;
    for (std::size_t i = 0; i < set.size(); ++i)
      if (!after[i].ok() && (place[i] == 9 || before[place[i]].ok())) expected = false;
    admitted += expected ? 1 : 0;
    REQUIRE(check.decide(period).admitted == expected);
  }
  CHECK(admitted > 200);
  CHECK(admitted < 1'800);
}

}  // namespace analysis_bus_check_test
