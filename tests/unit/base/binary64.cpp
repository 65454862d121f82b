// Numbers of 64 bits read into fewer: every case against the conversion of this machine's processor.
#include "ocm/base/binary64.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include <catch2/catch.hpp>

#include "unit/base/explore.hpp"
#include "unit/base/random.hpp"

namespace base_binary64_test {

using namespace ocm;
using base::from_binary64;
using base::to_binary64;

// Known bits [IEEE 754-2019, 3.4].
static_assert(from_binary64<float>(0x3FF0'0000'0000'0000) == 1.0F);
static_assert(from_binary64<float>(0xC037'8000'0000'0000) == -23.5F);
static_assert(from_binary64<double>(0xC037'8000'0000'0000) == -23.5);
static_assert(to_binary64(-23.5F) == 0xC037'8000'0000'0000);
static_assert(to_binary64(-23.5) == 0xC037'8000'0000'0000);
static_assert(to_binary64(std::numeric_limits<float>::denorm_min()) ==
              std::bit_cast<std::uint64_t>(0x1p-149));

bool same(float a, float b) {
  return (std::isnan(a) && std::isnan(b)) ||
         std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

TEST_CASE("A number of 64 bits becomes the nearest of 32") {
  for (const double value :
       {0.0, -0.0, 1e300, -1e300, 1e-300, 0x1p-149, 0x1p-150, 0x1.8p-150, 0x1p-126, 0x1.FFFFFFp-127,
        0x1.FFFFFEp127, 0x1.FFFFFFp127, 0x1.000001p0, 0x1.000003p0, std::numeric_limits<double>::infinity(),
        std::numeric_limits<double>::quiet_NaN()}) {
    CAPTURE(value);
    CHECK(same(from_binary64<float>(std::bit_cast<std::uint64_t>(value)), static_cast<float>(value)));
  }
  test::Random random{64};
  for (int i = 0; i < test::explored(100'000); ++i) {
    // Exponents that floats have, and somewhat beyond; all of them every other time.
    std::uint64_t bits = random.word();
    if (i % 2 == 0) bits = (bits & ~(std::uint64_t{0x7FF} << 52)) | (860 + random.word() % 320) << 52;
    CAPTURE(bits);
    REQUIRE(same(from_binary64<float>(bits), static_cast<float>(std::bit_cast<double>(bits))));
  }
}

TEST_CASE("A number of 32 bits keeps its value in 64") {
  test::Random random{32};
  for (int i = 0; i < test::explored(100'000); ++i) {
    const auto value =
        std::bit_cast<float>(static_cast<std::uint32_t>(random.word() >> (i % 2 == 0 ? 32 : 41)));
    CAPTURE(value);
    if (std::isnan(value)) continue;
    REQUIRE(to_binary64(value) == std::bit_cast<std::uint64_t>(static_cast<double>(value)));
    REQUIRE(same(from_binary64<float>(to_binary64(value)), value));
  }
}

}  // namespace base_binary64_test
