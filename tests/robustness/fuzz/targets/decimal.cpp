// A decimal number: what parses is normalised, prints, and reparses equal.
#include "ocm/base/decimal.hpp"

#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto number = base::parse_decimal(fuzz::text_of(data, size));
  if (!number) return 0;
  fuzz::expect(number->digits == 0 ? number->exponent == 0 : number->digits % 10 != 0,
               "a number that parses is normalised");
  fuzz::expect(
      number->exponent >= -base::max_decimal_exponent && number->exponent <= base::max_decimal_exponent,
      "a number that parses is within its range");
  const auto text = base::to_text(*number);
  fuzz::expect(!text.overflowed(), "the text of a number fits");
  const auto again = base::parse_decimal(text.view());
  fuzz::expect(again.ok() && *again == *number, "a number that is printed reparses equal");
  fuzz::expect(base::compare(*number, *again) == 0, "a number compares equal to itself");
  return 0;
}
