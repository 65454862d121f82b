#include "ocm/mapper/link/prefix.hpp"

#include <string>
#include <string_view>

#include <catch2/catch.hpp>

#include "unit/mapper/link/link_testing.hpp"

namespace mapper_link_prefix_test {

using namespace ocm::mapper::link;
using Step = PrefixFilter::Step;

static_assert(write_prefix(0, "AVR") == "[0]:AVR:");  // [Thesis 2, listing 15.1]
static_assert(write_prefix(255, "Arduino") == "[255]:Arduino:");
static_assert(write_prefix(255, "a name that is too long for it").view() == "[255]:a name that is too l:");
static_assert(!write_prefix(255, "a name that is too long for it").overflowed());
// No name can forge a prefix or a sentence.
static_assert(safe_name("a:b{c}[d]\n\x80") == "a_b_c__d___");
static_assert(safe_name(" ~\x7F\x1F") == " ~__");  // the first and the last of ASCII that are printed
static_assert(safe_name("") == "?");

// Where nothing else is said a stream has a central: without a prefix it is of no robot.
static_assert(PrefixFilter{}.feed('x') == Step::no_robot);
static_assert(PrefixFilter{true}.feed('x') == Step::text);

struct Stripped {
  std::string text;      ///< of sources that are known
  std::string no_robot;  ///< of no robot
  std::uint32_t broken = 0;
  std::string sources;
};
Stripped strip(std::string_view stream, bool known = false) {
  PrefixFilter filter{known};
  Stripped out;
  for (const char c : stream) {
    const Step step = filter.feed(c);
    if (step == Step::text) out.text += c;
    if (step == Step::no_robot) out.no_robot += c;
    if (step == Step::source) out.sources += std::to_string(filter.source()) + " ";
  }
  out.broken = filter.broken();
  return out;
}

TEST_CASE("prefixes are taken out of the middle of sentences, with or without the blank") {
  const Stripped s = strip(
      "[0] :AVR:{U,-177,-61,-68,49,0[0]:AVR:,0,0,0}\n"
      "[12]:Arduino:{S,IDL}\n");
  CHECK(s.text == "{U,-177,-61,-68,49,0,0,0,0}\n{S,IDL}\n");
  CHECK(s.sources == "0 0 12 ");
  CHECK(s.no_robot.empty());
  CHECK(s.broken == 0);
}

TEST_CASE("a broken prefix is counted, and what follows belongs to no robot until the next") {
  for (const std::string_view bad : {"[]", "[x", "[0x", "[0]x", "[0]::", "[0]   :", "[256]:A:", "[999]:A:",
                                     "[0000]", "[0]:a\n", "[0]:a{", "[0]:123456789012345678901",
                                     // And with all behind it that a whole one has.
                                     "[]:A:", "[0000]:A:", "[0]  ::"}) {
    INFO(bad);
    const Stripped s = strip("[1]:A:ab" + std::string{bad} + "cd[2]:B:ef");
    CHECK(s.text == "abef");
    CHECK(s.broken == 1);
    CHECK(s.sources == "1 2 ");
    CHECK(s.no_robot.substr(s.no_robot.size() - 2) == "cd");
  }
  CHECK(strip("[1]:A[2]:B:x").broken == 1);
  CHECK(strip("[1]:A[2]:B:x").text == "x");
}

TEST_CASE("the longest prefixes: two blanks, the last index, a name of 20 characters") {
  const Stripped s = strip("[0]  :A:x[255]:12345678901234567890:y");
  CHECK(s.text == "xy");
  CHECK(s.sources == "0 255 ");
  CHECK(s.broken == 0);
  const Stripped all_at_once = strip("[255]  :12345678901234567890:z");
  CHECK(all_at_once.text == "z");
  CHECK(all_at_once.broken == 0);
}

TEST_CASE("without a central there is one source; with one, none until the first prefix") {
  CHECK(strip("{S,IDL}\n", true).text == "{S,IDL}\n");
  CHECK(strip("{S,IDL}\n").text.empty());
  CHECK(strip("{S,IDL}\n").no_robot == "{S,IDL}\n");
  CHECK(strip("ab[3]:C:cd", true).text == "abcd");
}

TEST_CASE("every prefix that is written is taken out again") {
  ocm::test::Random random{5};
  for (int n = 0; n < 2000; ++n) {
    std::string name;
    for (std::uint32_t i = random.below(30); i > 0; --i) name += static_cast<char>(random.below(256));
    const auto index = static_cast<std::uint8_t>(random.below(256));
    const Stripped s = strip("x" + std::string{write_prefix(index, name).view()} + "y", true);
    REQUIRE(s.text == "xy");
    REQUIRE(s.sources == std::to_string(index) + " ");
  }
}

}  // namespace mapper_link_prefix_test
