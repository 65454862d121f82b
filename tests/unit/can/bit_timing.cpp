#include "ocm/can/bit_timing.hpp"

#include <cstdlib>
#include <optional>

#include <catch2/catch.hpp>

namespace can_bit_timing_test {

using ocm::base::Error;
using ocm::can::BitTiming;
using ocm::can::find_bit_timing;

// --- the robot's two chips ---

// STM32F103 at 72 MHz, APB1 36 MHz. [RM0008 24.7.7; AMiRo-OS 1.0: TS1 13, TS2 2, SJW 1]
constexpr std::uint32_t f1_pclk_hz = 36'000'000;
constexpr BitTiming f1{3, 13, 2, 1};
static_assert(f1.valid());
static_assert(f1.quanta() == 18);
static_assert(f1.exact(f1_pclk_hz));
static_assert(f1.bit_rate(f1_pclk_hz) == 500'000);
static_assert(f1.sample_point_permille() == 833);

// STM32F405 at 168 MHz, APB1 42 MHz. [RM0090 32.7.7; AMiRo-OS 1.0: TS1 15, TS2 3]
constexpr std::uint32_t f4_pclk_hz = 42'000'000;
constexpr BitTiming f4{3, 15, 3, 1};
static_assert(f4.valid());
static_assert(f4.quanta() == 21);
static_assert(f4.exact(f4_pclk_hz));
static_assert(f4.bit_rate(f4_pclk_hz) == 500'000);
static_assert(f4.sample_point_permille() == 810);

// AMiRo-OS itself runs at 1 Mbit/s: BRP 1 in both.
static_assert(BitTiming{1, 13, 2, 1}.bit_rate(f1_pclk_hz) == 1'000'000);
static_assert(BitTiming{1, 15, 3, 1}.bit_rate(f4_pclk_hz) == 1'000'000);

// The search finds the same fields when asked for the same sample point.
constexpr bool same_segments(BitTiming a, BitTiming b) {
  return a.brp == b.brp && a.ts1 == b.ts1 && a.ts2 == b.ts2;
}
static_assert(same_segments(*find_bit_timing(f1_pclk_hz, 500'000, 833), f1));
static_assert(same_segments(*find_bit_timing(f4_pclk_hz, 500'000, 810), f4));
// It jumps as far as the register has it, but never beyond segment 2.
static_assert(find_bit_timing(f1_pclk_hz, 500'000, 833)->sjw == 2);
static_assert(find_bit_timing(f4_pclk_hz, 500'000, 810)->sjw == 3);

// The thesis's equation, 8 MHz / ((13 + 2 + 1) * 1) = 500 kHz, takes the crystal for APB1's clock and the
// register's fields for the values themselves. With the fields of a register the crystal gives another rate,
// and 500 kbit/s of 8 MHz would need TS1 12, TS2 1.
static_assert(BitTiming{0, 13, 2, 1}.bit_rate(8'000'000) == 444'444);
static_assert(!BitTiming{0, 13, 2, 1}.exact(8'000'000));
static_assert(BitTiming{0, 12, 1, 1}.bit_rate(8'000'000) == 500'000);

// --- the search against all fields there are ---

/// Sample point as a fraction: sampled / quanta.
struct Best {
  long distance_permille = 0;
  std::uint32_t quanta = 0;
};

std::optional<Best> by_trying_everything(std::uint32_t pclk_hz, std::uint32_t bit_rate, long wanted) {
  std::optional<Best> best;
  for (std::uint32_t ts1 = 1; ts1 <= 16; ++ts1)
    for (std::uint32_t ts2 = 1; ts2 <= 8; ++ts2)
      for (std::uint32_t prescaler = 1; prescaler <= 1024; ++prescaler) {
        const std::uint32_t quanta = 1 + ts1 + ts2;
        if (quanta < 4) continue;  // the search starts there: ISO 11898-1 wants 8, and no controller takes 3
        if (std::uint64_t{bit_rate} * quanta * prescaler != pclk_hz) continue;
        const long point = static_cast<long>(((1 + ts1) * 1000 + quanta / 2) / quanta);
        const long distance = std::labs(point - wanted);
        if (!best || distance < best->distance_permille ||
            (distance == best->distance_permille && quanta > best->quanta))
          best = Best{distance, quanta};
      }
  return best;
}

TEST_CASE("the search finds the nearest sample point, and of equals the finest bit") {
  for (const std::uint32_t pclk :
       {8'000'000U, 12'345'678U, 36'000'000U, 42'000'000U, 48'000'000U, 1'000'000U})
    for (const std::uint32_t rate : {10'000U, 83'333U, 125'000U, 250'000U, 500'000U, 800'000U, 1'000'000U})
      for (const std::uint32_t point : {500U, 680U, 750U, 810U, 833U, 875U, 1000U}) {
        INFO(pclk << " Hz, " << rate << " bit/s, " << point << " permille");
        const auto found = find_bit_timing(pclk, rate, point);
        const auto truth = by_trying_everything(pclk, rate, point);
        REQUIRE(found.ok() == truth.has_value());
        if (!found) {
          REQUIRE(found.error == Error::out_of_range);
          continue;
        }
        REQUIRE(found->valid());
        REQUIRE(found->exact(pclk));
        REQUIRE(found->bit_rate(pclk) == rate);
        const long distance =
            std::labs(static_cast<long>(found->sample_point_permille()) - static_cast<long>(point));
        REQUIRE(distance == truth->distance_permille);
        REQUIRE(found->quanta() == truth->quanta);
      }
}

TEST_CASE("a rate that no fields give exactly is refused") {
  STATIC_REQUIRE(find_bit_timing(36'000'000, 0).error == Error::out_of_range);
  STATIC_REQUIRE(find_bit_timing(0, 500'000).error == Error::out_of_range);
  STATIC_REQUIRE(find_bit_timing(36'000'000, 499'999).error == Error::out_of_range);
  STATIC_REQUIRE(find_bit_timing(36'000'000, 36'000'000).error == Error::out_of_range);
  STATIC_REQUIRE(find_bit_timing(36'000'000, UINT32_MAX).error == Error::out_of_range);
  // 42 MHz gives no 800 kbit/s.
  STATIC_REQUIRE(find_bit_timing(42'000'000, 800'000).error == Error::out_of_range);
  STATIC_REQUIRE(find_bit_timing(42'000'000, 500'000).ok());
  // The slowest clock of the quanta is a 1024th.
  STATIC_REQUIRE(*find_bit_timing(25'600'000, 1000) == BitTiming{1023, 15, 7, 3});
  STATIC_REQUIRE(find_bit_timing(25'625'000, 1000).error == Error::out_of_range);
}

TEST_CASE("fields that the register does not have are not valid") {
  STATIC_REQUIRE(BitTiming{1023, 15, 7, 3}.valid());
  STATIC_REQUIRE_FALSE(BitTiming{1024, 15, 7, 3}.valid());
  STATIC_REQUIRE_FALSE(BitTiming{0, 16, 7, 3}.valid());
  STATIC_REQUIRE_FALSE(BitTiming{0, 15, 8, 3}.valid());
  STATIC_REQUIRE_FALSE(BitTiming{0, 15, 7, 4}.valid());
  // A jump longer than segment 2 would pass the end of the bit.
  STATIC_REQUIRE_FALSE(BitTiming{0, 15, 1, 2}.valid());
  STATIC_REQUIRE(BitTiming{0, 15, 2, 2}.valid());
}

}  // namespace can_bit_timing_test
