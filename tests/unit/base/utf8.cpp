#include "ocm/base/utf8.hpp"

#include <string>

#include <catch2/catch.hpp>

namespace base_utf8_test {

using ocm::base::columns;
using ocm::base::continues_character;
using ocm::base::is_utf8;
using ocm::base::unicode_of;
using ocm::base::utf8_length;
using ocm::base::utf8_of;

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

static_assert(continues_character('\x80') && continues_character('\xBF'));
static_assert(!continues_character('\x7F') && !continues_character('\xC0') && !continues_character('a'));

// [RFC 3629, 7]
static_assert(utf8_of(U'A').view() == "A");
static_assert(utf8_of(0x391).view() == "\xCE\x91");
static_assert(utf8_of(0x2262).view() == "\xE2\x89\xA2");
static_assert(utf8_of(0x233B4).view() == "\xF0\xA3\x8E\xB4");
static_assert(unicode_of("\xF0\xA3\x8E\xB4") == 0x233B4);

TEST_CASE("UTF-8: every number of Unicode, there and back") {
  char32_t wrong = 0;
  for (char32_t code = 0; code <= 0x10FFFF; ++code) {
    if (code >= 0xD800 && code < 0xE000) continue;
    const auto character = utf8_of(code);
    const std::size_t expected = code < 0x80 ? 1 : code < 0x800 ? 2 : code < 0x10000 ? 3 : 4;
    if (character.size != expected || utf8_length(character.view()) != expected ||
        unicode_of(character.view()) != code || !is_utf8(character.view()) || columns(character.view()) != 1)
      ++wrong;
  }
  CHECK(wrong == 0);
  for (char32_t half = 0xD800; half < 0xE000; ++half)
    wrong += utf8_length(utf8_of(half).view()) == 0 ? 0U : 1U;
  CHECK(wrong == 0);
}

TEST_CASE("UTF-8: a text is none from its first wrong byte on, wherever that is") {
  CHECK(is_utf8(""));
  const std::string good = "eight or more letters, \xC2\xB0 and \xE2\x82\xAC";
  CHECK(is_utf8(good));
  for (std::size_t at = 0; at < good.size(); ++at) {
    CAPTURE(at);
    std::string bad = good;
    bad[at] = '\xFF';
    CHECK_FALSE(is_utf8(bad));
  }
  for (const std::size_t short_of : {1U, 2U})
    CHECK_FALSE(is_utf8(std::string_view{good}.substr(0, good.size() - short_of)));
  for (const char* none : {"\xC0\x80", "\xE0\x80\x80", "\xED\xA0\x80", "\xF0\x80\x80\x80", "\xF4\x90\x80\x80",
                           "\xF5\x80\x80\x80", "\xC2", "\x80", "\xE2\x82"})
    CHECK_FALSE(is_utf8(none));
  for (const char* some :
       {"", "a", "\xC2\x80", "\xE0\xA0\x80", "\xED\x9F\xBF", "\xF0\x90\x80\x80", "\xF4\x8F\xBF\xBF"})
    CHECK(is_utf8(some));
}

}  // namespace base_utf8_test
