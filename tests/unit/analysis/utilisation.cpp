#include "ocm/analysis/utilisation.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"

namespace analysis_utilisation_test {

using namespace ocm::analysis;

constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();

// The thirds that no binary number holds.
constexpr auto thirds = utilisation(std::array{Task{1, 3}, Task{1, 3}, Task{1, 3}});
static_assert(thirds.numerator() == 1 && thirds.denominator() == 1);
static_assert(thirds.versus_one() == Comparison::equal && thirds.parts_per_million() == 1'000'000);

constexpr auto at_one = utilisation(std::array{Task{40, 80}, Task{10, 40}, Task{5, 20}});
static_assert(at_one.versus_one() == Comparison::equal);
static_assert(utilisation(std::array{Task{40, 80}, Task{10, 40}, Task{4, 20}}).versus_one() ==
              Comparison::below);
static_assert(utilisation(std::array{Task{40, 80}, Task{10, 40}, Task{6, 20}}).versus_one() ==
              Comparison::above);
static_assert(utilisation(std::array<Task, 0>{}).parts_per_million() == 0);
static_assert(utilisation(std::array{Task{1, 3}}).parts_per_million() == 333'334);  // rounded up
static_assert(utilisation(std::array{Task{7, 2}, Task{1, 8}}).numerator() == 29);   // 3 5/8
static_assert(utilisation(std::array{Task{7, 2}, Task{1, 8}}).parts_per_million() == 3'625'000);

// Periods whose common multiple has no 63 bits: the fraction is gone, the comparison is not.
constexpr std::array huge{Task{most / 2, most}, Task{1, most - 1}, Task{most / 2 - 3, most - 2}};
static_assert(utilisation(huge).denominator() == 0);
static_assert(utilisation(huge).versus_one() != Comparison::above);
static_assert(utilisation(huge).parts_per_million() == 1'000'000 ||
              utilisation(huge).parts_per_million() == 1'000'001);
constexpr std::array huge_above{Task{most / 2, most}, Task{most / 2, most - 1}, Task{most / 1000, most - 2}};
static_assert(utilisation(huge_above).versus_one() == Comparison::above);
static_assert(utilisation(std::array{Task{most, 1}, Task{most, 1}}).versus_one() == Comparison::above);
static_assert(utilisation(std::array{Task{most, 1}, Task{most, 1}}).parts_per_million() == unbounded);
static_assert(!utilisation(std::array{Task{1, 0}}).valid() && !utilisation(std::array{Task{-1, 5}}).valid());
static_assert(utilisation(std::array{Task{1, 0}}).versus_one() == Comparison::undecided);
// Parts per million are rounded up there, too: of nearly nothing to one, of just below 1/64 to 1/64.
constexpr std::array tiny{Task{1, most}, Task{1, most - 1}};
static_assert(utilisation(tiny).denominator() == 0 && utilisation(tiny).parts_per_million() == 1);
constexpr std::array below_a_64th{Task{most / 64 - 100, most - 1}, Task{1, most}};
static_assert(utilisation(below_a_64th).denominator() == 0);
static_assert(utilisation(below_a_64th).parts_per_million() == 15'625);
// Above 1 by less than 62 digits tell; above 2 by as little.
constexpr std::array just_above{Task{most, most}, Task{1, most - 1}, Task{1, most - 2}};
static_assert(utilisation(just_above).denominator() == 0);
static_assert(utilisation(just_above).versus_one() == Comparison::undecided);
constexpr std::array above_two{Task{most, most}, Task{most, most}, Task{1, most - 1}, Task{1, most - 2}};
static_assert(utilisation(above_two).denominator() == 0);
static_assert(utilisation(above_two).versus_one() == Comparison::above);

// [Liu, Layland 1973]: 1, 0.8284, 0.7798, 0.7568, ... ln 2
static_assert(liu_layland_bound(0) == 0 && liu_layland_bound(1) == 1'000'000);
static_assert(liu_layland_bound(2) == 828'427 && liu_layland_bound(3) == 779'763);
static_assert(liu_layland_bound(4) == 756'828 && liu_layland_bound(8) == 724'061);

// One tick on either side of the bound of two tasks, 0.828427124746...: each U is half of it.
constexpr auto pair(std::int64_t cost) {
  return in_order(std::array{Task{cost, 1'000'000'000}, Task{cost, 1'000'000'000}});
}
static_assert(liu_layland(pair(414'213'562)) == Proof::proven);
static_assert(liu_layland(pair(414'213'563)) == Proof::not_proven);
static_assert(hyperbolic(pair(414'213'562)) == Proof::proven);
static_assert(hyperbolic(pair(414'213'563)) == Proof::not_proven);

// Exactly on the hyperbola: 3/2 * 4/3 = 2. No binary number holds 4/3. Liu and Layland's bound is exceeded.
constexpr auto on_the_hyperbola = in_order(std::array{Task{2, 6}, Task{4, 8}});
static_assert(hyperbolic(on_the_hyperbola) == Proof::proven);
static_assert(liu_layland(on_the_hyperbola) == Proof::not_proven);
static_assert(hyperbolic(in_order(std::array{Task{3, 7}, Task{4, 8}})) == Proof::not_proven);
static_assert(hyperbolic(in_order(std::array{Task{2, 6}, Task{4, 8}, Task{1, 1LL << 50}})) ==
              Proof::not_proven);
static_assert(hyperbolic(in_order(std::array{Task{2, 6}, Task{4, 8}, Task{1, most}})) == Proof::undecided);
static_assert(hyperbolic(in_order(std::array{Task{7, 7}})) == Proof::proven);
static_assert(liu_layland(in_order(std::array{Task{7, 7}})) == Proof::proven);
static_assert(liu_layland(in_order(std::array{Task{8, 7}})) == Proof::not_proven);
static_assert(hyperbolic(in_order(std::array{Task{8, 7}})) == Proof::not_proven);
// Exactly 2, of numbers whose sum has no 63 bits; and above it by less than 62 digits tell.
static_assert(hyperbolic(in_order(std::array{Task{most, most}})) == Proof::proven);
static_assert(hyperbolic(in_order(std::array{Task{most, most}, Task{1, most}})) == Proof::undecided);

// Products of 62 binary digits after the point, rounded down or up; 4 and more is beyond.
static_assert(detail::multiply(detail::one, detail::one, false) == detail::one &&
              detail::multiply(detail::one, detail::one, true) == detail::one);
static_assert(detail::multiply(detail::one + 1, detail::one + 1, false) == detail::one + 2);
static_assert(detail::multiply(detail::one + 1, detail::one + 1, true) == detail::one + 3);
static_assert(detail::multiply(0x5555'5555'5555'5555, 0x6000'0001'0000'0001, false) == 0x8000'0001'5555'5556);
static_assert(detail::multiply(0x5555'5555'5555'5555, 0x6000'0001'0000'0001, true) == 0x8000'0001'5555'5557);
static_assert(detail::multiply(2 * detail::one, 2 * detail::one - 1, false) == detail::beyond - 1);
static_assert(detail::multiply(2 * detail::one, 2 * detail::one, false) == detail::beyond);
static_assert(detail::multiply(detail::beyond, detail::one, false) == detail::beyond);

// (1 + load / n) ^ n against 2, where a load is rounded up by a digit: what reaches 2 from below is not above
// it, what has 2 between its two numbers is not decided, and 2 is not the end while more factors come.
static_assert(detail::layland_power({detail::one - 1, detail::one - 1}, 1) == Comparison::below);
static_assert(detail::layland_power({detail::one, detail::one}, 1) == Comparison::undecided);
static_assert(detail::layland_power({2 * detail::one, 2 * detail::one}, 2) == Comparison::above);

// Where they say nothing.
static_assert(liu_layland(std::array<Task, 0>{}) == Proof::bad_input);
static_assert(liu_layland(std::array{Task{1, 0}}) == Proof::bad_input);
static_assert(liu_layland(in_order(std::array{Task{1, 9}, Task{1, 7}})) == Proof::not_rate_monotonic);
static_assert(hyperbolic(std::array{Task{1, 7}, Task{1, 9}}) == Proof::not_rate_monotonic);  // peers
static_assert(hyperbolic(std::array{Task{1, 7, 6}}) == Proof::not_simple);
static_assert(hyperbolic(std::array{Task{1, 7, 7, 1}}) == Proof::not_simple);
static_assert(hyperbolic(std::array{Task{1, 7, 7, 0, 1}}) == Proof::not_simple);

#ifdef __SIZEOF_INT128__  // not on a Cortex-M
TEST_CASE("the two numbers around a utilisation have the fraction between them") {
  ocm::test::Random random{2};
  for (int i = 0; i < 20'000; ++i) {
    std::vector<Task> tasks;
    __extension__ using Wide = unsigned __int128;
    Wide low = 0;  // sums of 62 digits, by another way
    Wide high = 0;
    for (int k = random.within(1, 8); k > 0; --k) {
      const std::int64_t period = 1 + std::abs(random.digits(random.within(2, 62)));
      const std::int64_t cost = std::abs(random.digits()) % period;
      tasks.push_back({cost, period});
      const Wide shifted = static_cast<Wide>(cost) << 62U;
      low += shifted / static_cast<Wide>(period);
      high += (shifted + static_cast<Wide>(period) - 1) / static_cast<Wide>(period);
    }
    const Utilisation sum = utilisation(tasks);
    const Wide limit = static_cast<Wide>(1) << 64U;
    const auto saturated = [&](Wide value) {
      return value >= limit ? ~std::uint64_t{0} : static_cast<std::uint64_t>(value);
    };
    REQUIRE(sum.between().low == saturated(low));
    REQUIRE(sum.between().high == saturated(high));
    const auto one = static_cast<Wide>(1) << 62U;
    if (high < one) REQUIRE(sum.versus_one() == Comparison::below);
    if (low > one) REQUIRE(sum.versus_one() == Comparison::above);
    // Parts per million: not below the truth, and at most one too many.
    const auto parts = static_cast<Wide>(sum.parts_per_million());
    REQUIRE(parts << 62U >= low * 1'000'000);
    REQUIRE((parts - (parts > 2 ? 2 : parts)) << 62U <= high * 1'000'000);
  }
}
#endif

TEST_CASE("the bound falls towards ln 2") {
  std::int64_t last = 1'000'000;
  for (std::size_t n = 2; n <= 2048; n = n < 32 ? n + 1 : n * 2) {
    const std::int64_t bound = liu_layland_bound(n);
    CHECK(bound < last);
    const auto count = static_cast<double>(n);
    CHECK(static_cast<double>(bound) == Approx(1e6 * count * (std::exp2(1 / count) - 1)).margin(1.001));
    last = bound;
  }
  CHECK(last > 693'147);
}

TEST_CASE("what Liu and Layland prove, the hyperbola proves") {
  ocm::test::Random random{3};
  int proven = 0;
  int more = 0;
  for (int i = 0; i < 20'000; ++i) {
    std::vector<Task> tasks;
    const int count = random.within(1, 6);
    for (int k = 0; k < count; ++k) {
      const auto period = static_cast<std::int64_t>(10 + random.below(1'000'000));
      tasks.push_back(
          {1 + static_cast<std::int64_t>(random.below(static_cast<std::uint32_t>(period))) / count, period});
    }
    rate_monotonic(tasks);
    const Proof layland = liu_layland(tasks);
    const Proof product = hyperbolic(tasks);
    REQUIRE(layland != Proof::undecided);
    REQUIRE(product != Proof::undecided);
    if (layland == Proof::proven) REQUIRE(product == Proof::proven);
    proven += layland == Proof::proven ? 1 : 0;
    more += product == Proof::proven && layland != Proof::proven ? 1 : 0;
  }
  CHECK(proven > 1000);
  CHECK(more > 20);
}

TEST_CASE("every proof has words of its own") {
  std::set<std::string_view> words;
  for (int i = 0; i <= static_cast<int>(Proof::bad_input); ++i)
    CHECK(words.insert(describe(static_cast<Proof>(i))).second);
  CHECK(words.count("unknown") == 0);
}

}  // namespace analysis_utilisation_test
