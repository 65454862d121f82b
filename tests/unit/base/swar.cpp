#include "ocm/base/swar.hpp"

#include <string>

#include <catch2/catch.hpp>

#include "ocm/base/text.hpp"

#include "unit/base/random.hpp"

namespace base_swar_test {

using namespace ocm;
namespace swar = ocm::base::swar;

std::uint64_t word_of(const char (&text)[9]) {
  return swar::load64(text);
}

TEST_CASE("eight decimal digits are a number") {
  CHECK(swar::decimal(word_of("12345678")) == 12'345'678);
  CHECK(swar::decimal(word_of("00000000")) == 0);
  CHECK(swar::decimal(word_of("99999999")) == 99'999'999);
}

TEST_CASE("every byte in every place is a digit or not, decimal and hexadecimal") {
  for (unsigned place = 0; place < 8; ++place)
    for (unsigned byte = 0; byte < 256; ++byte) {
      char text[9] = "1a9F0c5B";
      text[place] = static_cast<char>(byte);
      const swar::Hex hex = swar::hex(swar::load64(text));
      const int value = base::hex_digit(text[place]);
      CHECK(hex.count() == (value < 0 ? place : 8));
      std::uint64_t expected = 0;
      for (unsigned i = 0; i < (value < 0 ? place : 8); ++i)
        expected |= static_cast<std::uint64_t>(base::hex_digit(text[i])) << 8 * i;
      CHECK(hex.values == expected);

      char digits[9] = "12345678";
      digits[place] = static_cast<char>(byte);
      CHECK(swar::are_digits(swar::load64(digits)) == base::is_digit(digits[place]));
    }
}

TEST_CASE("any eight characters count their digits as one by one") {
  test::Random random{7};
  for (int round = 0; round < 200'000; ++round) {
    char text[9] = {};
    for (int i = 0; i < 8; ++i)
      text[i] =
          random.below(12) == 0 ? static_cast<char>(random()) : "0123456789abcdefABCDEF"[random.below(22)];
    unsigned count = 0;
    while (count < 8 && base::hex_digit(text[count]) >= 0) ++count;
    REQUIRE(swar::hex(swar::load64(text)).count() == count);
  }
}

TEST_CASE("hexadecimal digits become bytes in their order") {
  const swar::Hex all = swar::hex(word_of("0123ABcd"));
  CHECK(all.bytes() == 0xCDAB'2301);
  CHECK(swar::big_endian(all.bytes()) == 0x0123'ABCD);
  CHECK(swar::hex(word_of("12 45678")).bytes() == 0x12);
}

TEST_CASE("numbers are written with the digits that were asked for") {
  char text[16] = {};
  CHECK(swar::eight_digits(text, 12'034'506) == text + 8);
  CHECK(std::string{text, 8} == "12034506");
  CHECK(swar::two_digits(text, 7) == text + 2);
  CHECK(std::string{text, 2} == "07");
  CHECK(swar::hex_byte(text, 0xA5) == text + 2);
  CHECK(std::string{text, 2} == "A5");
  CHECK(swar::copy(text, "xyz") == text + 3);
  CHECK(std::string{text, 3} == "xyz");
}

}  // namespace base_swar_test
