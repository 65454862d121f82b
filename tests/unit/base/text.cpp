#include "ocm/base/text.hpp"

#include <charconv>
#include <string>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"

namespace base_text_test {

using ocm::base::Error;
using ocm::base::parse_unsigned;
using ocm::base::Text;

TEST_CASE("numbers are written in decimal, padded on the left") {
  STATIC_REQUIRE(Text<20>{}.decimal(0) == "0");
  STATIC_REQUIRE(Text<20>{}.decimal(205) == "205");
  STATIC_REQUIRE(Text<20>{}.decimal(7, 3) == "007");
  STATIC_REQUIRE(Text<20>{}.decimal(1234, 3) == "1234");
  STATIC_REQUIRE(Text<20>{}.decimal(UINT64_MAX) == "18446744073709551615");
}

TEST_CASE("numbers are written in hexadecimal with a fixed number of digits") {
  STATIC_REQUIRE(Text<20>{}.hex(0x205, 3) == "205");
  STATIC_REQUIRE(Text<20>{}.hex(0xABCDEF, 8) == "00ABCDEF");
  STATIC_REQUIRE(Text<20>{}.hex(0xABCDEF, 2) == "EF");
  STATIC_REQUIRE(Text<20>{}.hex(UINT64_MAX, 16) == "FFFFFFFFFFFFFFFF");
}

TEST_CASE("what does not fit is not written, and that shows") {
  Text<4> text;
  text << "abcd";
  CHECK_FALSE(text.overflowed());
  text << 'e';
  CHECK(text.overflowed());
  CHECK(text == "abcd");
  Text<4> cut;
  cut << "ab";
  cut.decimal(12345);
  CHECK(cut == "ab12");
  CHECK(cut.overflowed());
  // Once it has overflowed it stays so, even if nothing more is written.
  cut << "";
  CHECK(cut.overflowed());
}

TEST_CASE("a text may hold any character, also a zero") {
  Text<3> text;
  text << 'a' << '\0' << 'b';
  CHECK(text.view().size() == 3);
  CHECK(text == std::string_view("a\0b", 3));
  STATIC_REQUIRE(Text<3>{} == "");
}

TEST_CASE("digits") {
  for (int c = -128; c < 128; ++c) {
    const auto character = static_cast<char>(c);
    const std::string_view all = "0123456789abcdef";
    auto place =
        all.find(character >= 'A' && character <= 'F' ? static_cast<char>(c - 'A' + 'a') : character);
    CHECK(ocm::base::hex_digit(character) == (place == all.npos ? -1 : static_cast<int>(place)));
    CHECK(ocm::base::is_digit(character) == (place < 10));
  }
}

TEST_CASE("unsigned numbers are read whole or not at all") {
  STATIC_REQUIRE(parse_unsigned("0") == 0);
  STATIC_REQUIRE(parse_unsigned("0042") == 42);
  STATIC_REQUIRE(parse_unsigned("7fF", 16) == 0x7FF);
  STATIC_REQUIRE(parse_unsigned("18446744073709551615") == UINT64_MAX);
  STATIC_REQUIRE(parse_unsigned("FFFFFFFFFFFFFFFF", 16) == UINT64_MAX);
  STATIC_REQUIRE(parse_unsigned("0000000000000000000000000001") == 1);
  STATIC_REQUIRE(parse_unsigned("18446744073709551616").error == Error::out_of_range);
  STATIC_REQUIRE(parse_unsigned("99999999999999999999").error == Error::out_of_range);
  STATIC_REQUIRE(parse_unsigned("10000000000000000", 16).error == Error::out_of_range);
  for (const auto bad : {"", "-1", "+1", " 1", "1 ", "1.0", "0x10", "1a", "1e3", "\xff"}) {
    INFO(bad);
    CHECK(parse_unsigned(bad).error == Error::bad_syntax);
  }
  for (const auto bad : {"", "g", "0x10", "1 ", "-1"}) {
    INFO(bad);
    CHECK(parse_unsigned(bad, 16).error == Error::bad_syntax);
  }
}

TEST_CASE("reading agrees with the standard library on random numbers of every size") {
  ocm::test::Random random{2};
  for (int i = 0; i < 20'000; ++i) {
    const std::uint64_t number = random.word() >> random.below(64);
    for (const unsigned base : {10U, 16U}) {
      char buffer[24];
      const auto end = std::to_chars(buffer, buffer + sizeof buffer, number, static_cast<int>(base)).ptr;
      const std::string_view text{buffer, static_cast<std::size_t>(end - buffer)};
      REQUIRE(parse_unsigned(text, base) == number);
      if (base == 10) REQUIRE(Text<20>{}.decimal(number) == text);
    }
  }
}

}  // namespace base_text_test
