#include "ocm/protocol/law.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <catch2/catch.hpp>

#include "ocm/protocol/topic.hpp"

#include "unit/base/explore.hpp"

namespace protocol_law_test {

using namespace ocm::protocol;
using ocm::base::Decimal;

// counts = 1 / d^2 + 100
constexpr Law law{{1, 0}, {100, 0}, {4, 0}, {1, -2}, {5, -1}};

static_assert(square_root(0) == 0 && square_root(-1) == 0 && square_root(1) == 1 && square_root(4) == 2);
static_assert(square_root(0.25) == 0.5 && square_root(0x1p-40) == 0x1p-20 && square_root(1e20) == 1e10);
static_assert(square_root(std::numeric_limits<double>::max()) > 1.34e154 &&
              square_root(std::numeric_limits<double>::max()) < 1.341e154);
static_assert(square_root(std::numeric_limits<double>::infinity()) ==
              std::numeric_limits<double>::infinity());

static_assert(rounded(0.19876, 4) == Decimal{1988, -4});
static_assert(rounded(0.00999996, 4) == Decimal{1, -2});  // rounded up to one digit more
static_assert(rounded(12345, 2) == Decimal{12, 3});
static_assert(rounded(7, 4) == Decimal{7, 0});
static_assert(rounded(0, 4) == Decimal{} && rounded(-1, 4) == Decimal{});
static_assert(rounded(std::numeric_limits<double>::infinity(), 4) == Decimal{});
static_assert(rounded(1e300, 4) == Decimal{} && rounded(1e-300, 4) == Decimal{});
static_assert(rounded(1e18, 4) == Decimal{1, 18} && rounded(1e-18, 4) == Decimal{1, -18});
static_assert(rounded(1.001e18, 4) == Decimal{} && rounded(0.999e-18, 4) == Decimal{});

static_assert(law.value(101) == 1 && law.value(104) == 0.5 && law.value(200) == 0.1);
static_assert(law.value(100) == std::numeric_limits<double>::infinity());
static_assert(law.value(0) == std::numeric_limits<double>::infinity());
static_assert(law.holds(104) && !law.holds(103) && !law.holds(100) && !law.holds(0));
static_assert(law.holds(10'100) && !law.holds(10'200));
// 0.5^3 * 4 / 2
static_assert(law.uncertainty(104) == 0.25);

// What is derived is on no wire: it has no raw number of its own, and a frame may be without it.
constexpr Field counts{"proximity", {0, 16}, false, {1, 0}, {}, "", 0, 65'535, {}, false};
constexpr Field fields[]{counts, derived(counts, 0, "distance", "m", law, false),
                         derived(counts, 0, "distance_uncertainty", "m", law, true)};
constexpr FrameLayout layout{"", TopicId{0x10}, 2, {fields, 1}, {}, fields};
static_assert(layout.fields.size() == 1 && layout.values().size() == 3);
static_assert(FrameLayout{"", TopicId{0x10}, 2, {fields, 1}}.values().size() == 1);
static_assert(!fields[0].is_derived() && fields[1].is_derived() && fields[2].uncertainty);
static_assert(!layout.may_lack(fields[0]) && layout.may_lack(fields[1]) && layout.may_lack(fields[2]));
static_assert(*fields[1].physical(200) == Decimal{1, -1} && fields[1].value(200) == 0.1);
static_assert(*fields[2].physical(200) == Decimal{2, -3});
static_assert(!fields[1].physical(100) && !fields[1].raw_from({1, -1}));
static_assert(fields[2].max == Decimal{25, -2});  // at the far end of the range

constexpr bool has(const Field& field, std::uint16_t raw, std::size_t bytes = 2) {
  const std::uint8_t data[]{static_cast<std::uint8_t>(raw), static_cast<std::uint8_t>(raw >> 8U)};
  return layout.has(field, {data, bytes});
}
static_assert(has(fields[0], 100) && !has(fields[1], 100) && !has(fields[2], 100));
static_assert(has(fields[1], 200) && has(fields[2], 200));
static_assert(!has(fields[1], 200, 1));

TEST_CASE("law: its root is the standard library's, but for the last bit") {
  std::mt19937_64 random{1};
  std::uniform_real_distribution<double> exponent{-12, 12};
  for (int i = 0, count = ocm::test::explored(20'000); i < count; ++i) {
    const double square = std::pow(10, exponent(random));
    const double root = std::sqrt(square);
    REQUIRE(std::abs(square_root(square) - root) <= root * 2.3e-16);
  }
}

TEST_CASE("law: of a scaled field the physical value counts") {
  Field half = counts;
  half.scale = {5, -1};
  half.offset = {-10, 0};
  const Field field = derived(half, 0, "distance", "m", law, false);
  CHECK(field.value(420) == 0.1);  // 200
  CHECK(*field.physical(420) == Decimal{1, -1});
}

TEST_CASE("law: the uncertainty is what noise makes of the value") {
  // Measured, not derived: the mean deviation of values whose counts have noise.
  std::mt19937_64 random{2};
  for (const double value : {0.02, 0.05, 0.1}) {
    const double measured = 100 + 1 / (value * value);
    std::normal_distribution<double> noise{0, 4};
    double squares = 0;
    constexpr int count = ocm::test::emulated ? 5'000 : 20'000;
    for (int i = 0; i < count; ++i) {
      const double off = law.value(measured + noise(random)) - value;
      squares += off * off;
    }
    // At 0.1 the noise is 4 % of the counts, and the second order no longer nothing.
    CHECK(std::sqrt(squares / count) == Approx(law.uncertainty(measured)).epsilon(0.04));
  }
}

}  // namespace protocol_law_test
