#include "ocm/mapper/link/quality.hpp"

#include <cstdint>

#include <catch2/catch.hpp>

namespace mapper_link_quality_test {

using ocm::mapper::link::LinkQuality;

constexpr LinkQuality after(int good, int bad) {
  LinkQuality quality;
  for (int n = 0; n < bad; ++n) quality.bad();
  for (int n = 0; n < good; ++n) quality.good();
  return quality;
}

static_assert(LinkQuality{}.per_mille() == 1000);
static_assert(!LinkQuality{}.below(1000));
// One bad sentence: 15/16. Eleven: (15/16)^11 = 0.4917.
static_assert(after(0, 1).per_mille() == 937);
static_assert(after(0, 11).per_mille() == 491);
static_assert(after(0, 11).below(500) && !after(0, 10).below(500));
// It reaches both ends and stays there.
static_assert(after(0, 1000).per_mille() == 0);
static_assert(after(1000, 1000).per_mille() == 1000);
static_assert(after(11, 1000).per_mille() == 508);

TEST_CASE("quality settles at the share of good sentences") {
  for (int good_of_ten = 0; good_of_ten <= 10; ++good_of_ten) {
    LinkQuality quality;
    std::uint32_t sum = 0;
    for (int n = 0; n < 1000; ++n) {
      n % 10 < good_of_ten ? quality.good() : quality.bad();
      if (n >= 900) sum += quality.per_mille();
    }
    CHECK(sum / 100.0 == Approx(100.0 * good_of_ten).margin(35));
  }
}

TEST_CASE("quality follows counters, also when they wrap or run far ahead") {
  LinkQuality quality;
  quality.observe(0, 1);
  CHECK(quality.per_mille() == 937);
  quality.observe(0, 1);
  CHECK(quality.per_mille() == 937);  // nothing new
  quality.observe(1000, 1);
  CHECK(quality.per_mille() > 990);
  quality.observe(1000, UINT32_MAX);
  CHECK(quality.per_mille() < 10);
  const auto before = quality.per_mille();
  quality.observe(1001, 0);  // one more failed, wrapped; one heard
  CHECK(quality.per_mille() > before);
  quality.restart();
  CHECK(quality.per_mille() == 1000);
  quality.observe(1001, 0);
  CHECK(quality.per_mille() == 1000);
}

}  // namespace mapper_link_quality_test
