#include "ocm/analysis/checked.hpp"

#include <limits>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"

namespace analysis_checked_test {

using namespace ocm::analysis;

constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t least = std::numeric_limits<std::int64_t>::min();

static_assert((Checked{most} + 0).value() == most && !(Checked{most} + 1).ok());
static_assert((Checked{least} + 0).value() == least && !(Checked{least} + -1).ok());
static_assert((Checked{least} - -1).value() == least + 1 && !(Checked{0} - least).ok());
static_assert((Checked{-1} - least).value() == most && !(Checked{least} - 1).ok());
static_assert((Checked{most} * 1).value() == most && (Checked{most} * -1).value() == -most);
static_assert(!(Checked{most} * 2).ok() && !(Checked{1LL << 32} * (1LL << 31)).ok());
static_assert((Checked{1LL << 31} * (1LL << 31)).value() == 1LL << 62);
static_assert(!(Checked{-(1LL << 32)} * (1LL << 31)).ok());  // it would fit, by one: never a wrong number
static_assert((Checked{0} * least).value() == 0 && (Checked{least} * 0).value() == 0);

static_assert(ceil_div(0, 7).value() == 0 && ceil_div(1, 7).value() == 1 && ceil_div(7, 7).value() == 1);
static_assert(ceil_div(8, 7).value() == 2 && ceil_div(-1, 7).value() == 0 && ceil_div(-7, 7).value() == -1);
static_assert(floor_div(-1, 7).value() == -1 && floor_div(-7, 7).value() == -1 &&
              floor_div(6, 7).value() == 0);
static_assert(ceil_div(most, 1).value() == most && ceil_div(most, most).value() == 1);
static_assert(ceil_div(most, 2).value() == most / 2 + 1);  // (a + b - 1) / b would overflow
static_assert(!ceil_div(1, 0).ok() && !ceil_div(1, -1).ok() && !floor_div(least, -1).ok());

// Spoilt stays spoilt, and compares with nothing.
constexpr Checked spoilt = Checked{most} + 1;
static_assert(!(spoilt - 1).ok() && !(spoilt * 0).ok() && !ceil_div(spoilt, 1).ok() &&
              !ceil_div(1, spoilt).ok());
static_assert(!(spoilt == spoilt) && !(spoilt < 0) && !(spoilt > 0) && !(spoilt <= spoilt));
static_assert(spoilt.value_or(-5) == -5 && Checked{3}.value_or(-5) == 3);

#ifdef __SIZEOF_INT128__  // not on a Cortex-M
TEST_CASE("checked numbers agree with 128 bits, or say that they cannot") {
  ocm::test::Random random{1};
  __extension__ using Wide = __int128;
  const auto agrees = [](Checked result, Wide truth) {
    if (truth > most || truth < least) return !result.ok();
    // A product may be refused at the edge of the negative numbers, which are no times.
    return result.ok() ? result.value() == truth : truth == least;
  };
  bool right = true;
  for (int i = 0; i < 200'000; ++i) {
    const std::int64_t a = random.digits();
    const std::int64_t b = random.digits();
    right = right && agrees(Checked{a} + b, Wide{a} + b) && agrees(Checked{a} - b, Wide{a} - b) &&
            agrees(Checked{a} * b, Wide{a} * b);
    if (b < 1) continue;
    const Wide floor = a / b - (a % b < 0 ? 1 : 0);
    right = right && agrees(floor_div(a, b), floor) && agrees(ceil_div(a, b), floor + (a % b != 0 ? 1 : 0));
  }
  CHECK(right);
}
#endif

}  // namespace analysis_checked_test
