#include "ocm/base/decimal.hpp"

#include <cstdlib>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"

namespace base_decimal_test {

using ocm::base::add;
using ocm::base::compare;
using ocm::base::Decimal;
using ocm::base::divide_rounded;
using ocm::base::Error;
using ocm::base::multiply;
using ocm::base::parse_decimal;
using ocm::base::subtract;
using ocm::base::to_text;
using ocm::test::Random;

constexpr Decimal number(const char* text) {
  return *parse_decimal(text);
}

#if defined(__SIZEOF_INT128__)
// Words of 128 bits are an extension: the library does without them, and here they judge it, where the
// compiler has them; for a Cortex-M it has none.
__extension__ using Wide = __int128;

Wide power(int n) {
  Wide p = 1;
  while (n-- > 0) p *= 10;
  return p;
}
#endif

/// Digits of at most so many bits, with an exponent of low..high before normalisation.
Decimal any_decimal(Random& random, int most_bits, int low, int high) {
  const std::int64_t digits = random.digits(most_bits);
  return ocm::base::normalised(digits, random.within(low, high));
}

// --- vectors ---

// L3G4200D at +-500 deg/s: 17.5 mdeg/s a digit. In binary floating point 3 * 0.0175 is 0.052500000000000005.
static_assert(*multiply({3, 0}, number("0.0175")) == number("0.0525"));
static_assert(to_text(*multiply({3, 0}, number("0.0175"))) == "0.0525");
// The thesis's demo printed 65532 where the gyroscope turned at -0.07 deg/s.
static_assert(to_text(*multiply({static_cast<std::int16_t>(65532), 0}, number("0.0175"))) == "-0.07");
// LIS331DLH: 1/1024 g, which is a finite decimal.
static_assert(to_text(*multiply({1024, 0}, number("0.0009765625"))) == "1");
static_assert(to_text(*multiply({-2, 0}, number("0.0009765625"))) == "-0.001953125");
// HMC5883L: 1 uG.
static_assert(to_text(*multiply({-939520, 0}, number("0.000001"))) == "-0.93952");

TEST_CASE("text becomes the number it says") {
  STATIC_REQUIRE(number("0.0175") == Decimal{175, -4});
  STATIC_REQUIRE(number("-0.0175") == Decimal{-175, -4});
  STATIC_REQUIRE(number("+12") == Decimal{12, 0});
  STATIC_REQUIRE(number(".5") == Decimal{5, -1});
  STATIC_REQUIRE(number("5.") == Decimal{5, 0});
  STATIC_REQUIRE(number("1e-3") == Decimal{1, -3});
  STATIC_REQUIRE(number("1.5E+3") == Decimal{15, 2});
  STATIC_REQUIRE(number("1200") == Decimal{12, 2});
  STATIC_REQUIRE(number("000.500") == Decimal{5, -1});
  STATIC_REQUIRE(number("-0") == Decimal{});
  STATIC_REQUIRE(number("0e50") == Decimal{});
  STATIC_REQUIRE(number("9223372036854775807") == Decimal{INT64_MAX, 0});
  STATIC_REQUIRE(number("-9223372036854775808") == Decimal{INT64_MIN, 0});
  STATIC_REQUIRE(number("1e100") == Decimal{1, 100});
  STATIC_REQUIRE(number("1e-100") == Decimal{1, -100});
  const std::string small = "0." + std::string(99, '0') + "1", large = "1" + std::string(100, '0');
  CHECK(parse_decimal(small + "e200").value == Decimal{1, 100});
  CHECK(parse_decimal(large + "e-200").value == Decimal{1, -100});
  CHECK(parse_decimal(small + "e201").error == Error::out_of_range);
  STATIC_REQUIRE(number("100e98") == Decimal{1, 100});
  STATIC_REQUIRE(number("-12345678901234567890") ==
                 Decimal{-1234567890123456789, 1});  // 63 bits hold its digits
  STATIC_REQUIRE(number("1.00000000000000000000") == Decimal{1, 0});
}

TEST_CASE("text that is no number is refused") {
  for (const auto bad :
       {"",    "-",    "+",  ".",   "-.",  "e3",    "1e",   "1e+", "1e-", "1.2.3", "--1",  " 1",   "1 ",
        "1,5", "0x10", "1f", "nan", "inf", "1e1.5", "1e 3", "+-1", "1-",  ".e1",   "1ee1", "1e--1"}) {
    INFO(bad);
    CHECK(parse_decimal(bad).error == Error::bad_syntax);
  }
}

TEST_CASE("text of a number that is too large, too fine or too long is refused") {
  const std::string zeros(101, '0');
  for (const auto& bad : std::initializer_list<std::string>{
           "9223372036854775808", "-9223372036854775809", "1e101", "10e100", "1e-101", "0.1e-100",
           "1e9999999", "1e99999999999999999999999", "12345678901234567891", "0." + zeros + "1"}) {
    INFO(bad);
    CHECK(parse_decimal(bad).error == Error::out_of_range);
  }
}

TEST_CASE("numbers print in plain notation, shortest") {
  STATIC_REQUIRE(to_text({}) == "0");
  STATIC_REQUIRE(to_text({525, -4}) == "0.0525");
  STATIC_REQUIRE(to_text({-525, -4}) == "-0.0525");
  STATIC_REQUIRE(to_text({12345, -2}) == "123.45");
  STATIC_REQUIRE(to_text({5, -1}) == "0.5");
  STATIC_REQUIRE(to_text({12, 2}) == "1200");
  STATIC_REQUIRE(to_text({INT64_MIN, 0}) == "-9223372036854775808");
  STATIC_REQUIRE(to_text({INT64_MIN, -19}) == "-0.9223372036854775808");
  STATIC_REQUIRE(to_text({INT64_MIN, -18}) == "-9.223372036854775808");
  // The longest: nothing of it is lost.
  STATIC_REQUIRE(to_text({INT64_MIN + 1, 100}).view().size() == 120);
  STATIC_REQUIRE_FALSE(to_text({INT64_MIN + 1, 100}).overflowed());
  STATIC_REQUIRE_FALSE(to_text({INT64_MIN + 1, -100}).overflowed());
}

TEST_CASE("printing and parsing are each other's inverse") {
  Random random{3};
  for (int i = 0; i < 20'000; ++i) {
    // Numbers that plain notation can hold: digits with the zeros behind them within 63 bits.
    const auto original = any_decimal(random, 63, -80, 0);
    const auto text = to_text(original);
    INFO(std::string{text.view()});
    REQUIRE(parse_decimal(text.view()) == original);
  }
}

// --- arithmetic against words of 128 bits ---

#if defined(__SIZEOF_INT128__)
/// A number as value * 10^-scale in 128 bits, where the test chooses exponents so that it fits.
Wide at_scale(Decimal d, int scale) {
  return d.digits * power(d.exponent + scale);
}

std::optional<Decimal> expected(Wide value, int exponent) {
  if (value == 0) return Decimal{};
  while (value % 10 == 0) value /= 10, ++exponent;
  if (value > INT64_MAX || value < INT64_MIN) return std::nullopt;
  return Decimal{static_cast<std::int64_t>(value), static_cast<std::int8_t>(exponent)};
}

TEST_CASE("sums and products are exact, or refused") {
  Random random{4};
  int refused = 0;
  int exact = 0;
  for (int i = 0; i < 100'000; ++i) {
    const auto a = any_decimal(random, 63, -9, 0);
    const auto b = any_decimal(random, 63, -9, 0);
    INFO(std::string{to_text(a).view()} << " and " << std::string{to_text(b).view()});

    const Wide x = at_scale(a, 9);
    const Wide y = at_scale(b, 9);
    for (const auto& [ours, truth] :
         {std::pair{add(a, b), expected(x + y, -9)}, std::pair{subtract(a, b), expected(x - y, -9)},
          std::pair{multiply(a, b), expected(Wide{a.digits} * b.digits, a.exponent + b.exponent)}}) {
      if (ours) {
        REQUIRE(truth.has_value());
        REQUIRE(*ours == *truth);
        ++exact;
      } else {
        REQUIRE(ours.error == Error::out_of_range);
        ++refused;
      }
    }
    REQUIRE(compare(a, b) == (x < y ? -1 : x > y));
    REQUIRE(compare(b, a) == (x > y ? -1 : x < y));
    REQUIRE(compare(a, a) == 0);
  }
  // Refusing everything would pass the loop.
  CHECK(exact > 100'000);
  CHECK(refused > 10'000);
}
#endif

TEST_CASE("what 63 bits hold is never refused") {
  Random random{5};
  for (int i = 0; i < 20'000; ++i) {
    const Decimal a = any_decimal(random, 31, -9, 0);
    const Decimal b = any_decimal(random, 31, -9, 0);
    REQUIRE(multiply(a, b).ok());
    REQUIRE(add(a, b).ok());
  }
  STATIC_REQUIRE(add({INT64_MAX, 0}, {}) == Decimal{INT64_MAX, 0});
  STATIC_REQUIRE(add({INT64_MAX, 0}, {-1, 0}) == Decimal{INT64_MAX - 1, 0});
  STATIC_REQUIRE(add({INT64_MAX, 0}, {1, 0}).error == Error::out_of_range);
  STATIC_REQUIRE(subtract({1, 0}, {INT64_MIN, 0}).error == Error::out_of_range);
  STATIC_REQUIRE(multiply({INT64_MIN, 0}, {-1, 0}).error == Error::out_of_range);
  STATIC_REQUIRE(multiply({INT64_MIN, 0}, {1, 0}) == Decimal{INT64_MIN, 0});
}

TEST_CASE("an exponent that leaves its range is refused and does not wrap") {
  STATIC_REQUIRE(multiply({1, -100}, {1, -100}).error == Error::out_of_range);
  STATIC_REQUIRE(multiply({1, 100}, {1, 100}).error == Error::out_of_range);
  STATIC_REQUIRE(multiply({5, 100}, {2, 0}).error == Error::out_of_range);
  STATIC_REQUIRE(multiply({1, -100}, {1, 100}) == Decimal{1, 0});
  STATIC_REQUIRE(add({5, 100}, {5, 100}).error == Error::out_of_range);
  STATIC_REQUIRE(add({1, 100}, {1, -100}).error == Error::out_of_range);
  STATIC_REQUIRE(multiply({0, 0}, {1, 100}) == Decimal{});
}

TEST_CASE("numbers that are far apart compare without overflow") {
  STATIC_REQUIRE(compare({1, 100}, {INT64_MAX, 0}) == 1);
  STATIC_REQUIRE(compare({-1, 100}, {INT64_MIN, 0}) == -1);
  STATIC_REQUIRE(compare({INT64_MAX, -100}, {1, 0}) == -1);
  STATIC_REQUIRE(compare({INT64_MIN, -100}, {-1, 0}) == 1);
  STATIC_REQUIRE(compare({1, -100}, {}) == 1);
  STATIC_REQUIRE(compare({-1, 100}, {1, -100}) == -1);
  STATIC_REQUIRE(compare({10, 0}, {1, 1}) == 0);  // also when not normalised
}

#if defined(__SIZEOF_INT128__)
/// a / b, halves away from zero; nothing where int64 does not hold it.
std::optional<std::int64_t> quotient(Wide a, Wide b) {
  const bool negative = (a < 0) != (b < 0);
  if (a < 0) a = -a;
  if (b < 0) b = -b;
  Wide q = a / b;
  if (a % b >= b - a % b) ++q;
  if (negative) q = -q;
  if (q > INT64_MAX || q < INT64_MIN) return std::nullopt;
  return static_cast<std::int64_t>(q);
}

TEST_CASE("a quotient is the nearest whole number, for every pair whose quotient 63 bits hold") {
  Random random{6};
  int refused = 0;
  for (int i = 0; i < 200'000; ++i) {
    const Decimal a{random.digits(), static_cast<std::int8_t>(random.within(-18, 0))};
    const Decimal b{random.digits(), static_cast<std::int8_t>(random.within(-18, 0))};
    if (b.digits == 0) {
      REQUIRE(divide_rounded(a, b).error == Error::out_of_range);
      continue;
    }
    INFO(a.digits << "e" << int{a.exponent} << " / " << b.digits << "e" << int{b.exponent});
    // One of the two is scaled, by 10^18 at most: 63 + 60 bits.
    const int low = a.exponent < b.exponent ? a.exponent : b.exponent;
    const auto truth = quotient(a.digits * power(a.exponent - low), b.digits * power(b.exponent - low));
    const auto ours = divide_rounded(a, b);
    if (truth) {
      REQUIRE(ours == *truth);
    } else {
      REQUIRE(ours.error == Error::out_of_range);
      ++refused;
    }
  }
  CHECK(refused > 1'000);
}
#endif

TEST_CASE("quotients at the edges") {
  STATIC_REQUIRE(divide_rounded({5, 0}, {2, 0}) == 3);
  STATIC_REQUIRE(divide_rounded({-5, 0}, {2, 0}) == -3);
  STATIC_REQUIRE(divide_rounded({5, 0}, {-2, 0}) == -3);
  STATIC_REQUIRE(divide_rounded({49, -1}, {2, 0}) == 2);
  STATIC_REQUIRE(divide_rounded({}, {1, -100}) == 0);
  STATIC_REQUIRE(divide_rounded({1, 0}, {}).error == Error::out_of_range);
  // 9.22 / 10: the divisor, scaled up, needs 64 bits.
  STATIC_REQUIRE(divide_rounded({INT64_MAX, -18}, {1, 1}) == 1);
  // 5e18 / 1e19 is a half, and one digit less is not.
  STATIC_REQUIRE(divide_rounded({5'000'000'000'000'000'000, 0}, {1, 19}) == 1);
  STATIC_REQUIRE(divide_rounded({4'999'999'999'999'999'999, 0}, {1, 19}) == 0);
  STATIC_REQUIRE(divide_rounded({INT64_MIN, 0}, {1, 0}) == INT64_MIN);
  STATIC_REQUIRE(divide_rounded({INT64_MIN, 0}, {-1, 0}).error == Error::out_of_range);
  STATIC_REQUIRE(divide_rounded({1, 100}, {1, -100}).error == Error::out_of_range);
  STATIC_REQUIRE(divide_rounded({1, -100}, {1, 100}) == 0);
  STATIC_REQUIRE(divide_rounded({1, 100}, {1, 100}) == 1);
  STATIC_REQUIRE(divide_rounded({1, -100}, {3, -101}) == 3);
  // 2e9 g in steps of 1/1024 g.
  STATIC_REQUIRE(divide_rounded({2, 9}, {9765625, -10}) == 2'048'000'000'000);
}

TEST_CASE("a double is the nearest one as long as 53 bits hold the digits") {
  Random random{7};
  for (int i = 0; i < 20'000; ++i) {
    const auto d = any_decimal(random, 53, -22, 6);
    const auto text = to_text(d);
    if (std::llabs(d.digits) >= 1LL << 53) continue;
    INFO(std::string{text.view()});
    REQUIRE(d.as_double() == std::strtod(std::string{text.view()}.c_str(), nullptr));
  }
  CHECK(Decimal{525, -4}.as_double() == 0.0525);
  CHECK(Decimal{1, 100}.as_double() == Approx(1e100));
}

}  // namespace base_decimal_test
