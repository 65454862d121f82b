#include "ocm/base/utf8.hpp"

#include <catch2/catch.hpp>

namespace base_utf8_test {

using ocm::base::columns;

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

}  // namespace base_utf8_test
