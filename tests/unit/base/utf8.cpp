#include "ocm/base/utf8.hpp"

#include <catch2/catch.hpp>

namespace base_utf8_test {

using ocm::base::columns;
using ocm::base::utf8_length;

static_assert(columns("") == 0);
static_assert(columns("gyro") == 4);
static_assert(columns("\xC2\xB0") == 1, "a degree sign: two bytes [RFC 3629, 3]");
static_assert(columns("\xE2\x82\xAC") == 1, "a euro sign: three bytes");
static_assert(columns("\xF0\x9F\xA4\x96") == 1, "four bytes");
static_assert(columns("deg/s\xC2\xB2") == 6);

TEST_CASE("What is no UTF-8 is counted, too") {
  CHECK(columns("\xFF") == 1);
  CHECK(columns("\x80\x80") == 0);
  CHECK(columns("a\xC2") == 2);
}

static_assert(utf8_length("") == 0);
static_assert(utf8_length("ab") == 1);
static_assert(utf8_length("\xC2\xB0x") == 2);
static_assert(utf8_length("\xC2x") == 0 && utf8_length("\xC2") == 0 && utf8_length("\x9B") == 0);
static_assert(utf8_length("\xC0\xAF") == 0, "longer than needed [RFC 3629, 3]");
static_assert(utf8_length("\xED\xA0\x80") == 0, "a half of a pair of UTF-16");
static_assert(utf8_length("\xF4\x8F\xBF\xBF") == 4, "U+10FFFF, the last [RFC 3629, 3]");
static_assert(utf8_length("\xF4\x90\x80\x80") == 0 && utf8_length("\xF5\x80\x80\x80") == 0, "beyond it");

}  // namespace base_utf8_test
