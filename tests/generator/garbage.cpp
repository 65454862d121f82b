// Any bytes are at worst a problem: truncations and mutations of real specs, seeded. Run it with sanitizers.
#include <fstream>
#include <random>
#include <sstream>

#include <catch2/catch.hpp>

#include "generator/spec/spec.hpp"
#include "unit/base/explore.hpp"

namespace generator_garbage_test {

std::string read(const std::string& name) {
  std::ifstream in{std::string{OCM_SOURCE_DIR} + "/" + name, std::ios::binary};
  REQUIRE(in);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// What must hold for every text; returns whether it was a spec.
bool parse(std::string_view text) {
  const auto loaded = ocm::spec::parse(text, "f");
  if ((loaded.spec != nullptr) != loaded.problems.empty()) FAIL("a spec with problems, or neither: " << text);
  for (const auto& p : loaded.problems)
    if (p.place.empty() || p.what.empty() || p.remedy.empty()) FAIL("a problem without words: " << text);
  if (loaded.spec && loaded.spec->catalogue().topics.empty()) FAIL("a spec without topics: " << text);
  return loaded.spec != nullptr;
}

TEST_CASE("a spec that is cut off anywhere is reported") {
  const std::string whole = read("tests/generator/good.json");
  std::size_t end = whole.size();
  while (whole[end - 1] != '}') --end;
  for (std::size_t n = 0; n < end; ++n)
    if (parse(std::string_view{whole}.substr(0, n))) FAIL("accepted after " << n << " bytes");
  CHECK(parse(whole));
}

TEST_CASE("mutated specs never crash, and are accepted or told why not") {
  const std::string specs[] = {read("tests/generator/good.json"), read("examples/other-robot/topics.json")};
  const std::vector<std::string> pieces = {"{",
                                           "}",
                                           "[",
                                           "]",
                                           ",",
                                           ":",
                                           "\"",
                                           "null",
                                           "true",
                                           "-1",
                                           "0",
                                           "1e99",
                                           "-1e-99",
                                           "255",
                                           "256",
                                           "[]",
                                           "{}",
                                           "\"\"",
                                           "\\",
                                           "\xFF",
                                           "\xC3\xA9",
                                           "\"0xFF\"",
                                           "\"i64\"",
                                           "\"u63\"",
                                           "\"i2\"",
                                           "63",
                                           "\"big\"",
                                           "9223372036854775807",
                                           "-9223372036854775808",
                                           "18446744073709551615",
                                           "0.1234567890123456789",
                                           "1e-100",
                                           "1e100",
                                           "\"x\"",
                                           "\"50ms\"",
                                           "\n"};
  std::mt19937 random{20240607};
  const auto below = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>{0, n - 1}(random);
  };
  std::size_t accepted = 0;
  const int rounds = ocm::test::explored(4'000);
  for (int round = 0; round < rounds; ++round) {
    std::string text = specs[below(2)];
    for (std::size_t changes = 1 + below(3); changes > 0; --changes) {
      const std::size_t at = below(text.size());
      switch (below(5)) {
        case 0:
          text[at] = static_cast<char>(below(256));
          break;
        case 1:
          text.erase(at, 1 + below(20));
          break;
        case 2:
          text.insert(at, pieces[below(pieces.size())]);
          break;
        case 3: {  // another value in the place of a word or number
          const auto first = text.find_first_of("\"0123456789", at);
          if (first == std::string::npos) break;
          const auto last = text.find_first_of(",}]\n", first);
          text.replace(first, last - first, pieces[below(pieces.size())]);
          break;
        }
        default: {  // a piece of the same text somewhere else
          const std::string copy = text.substr(below(text.size()), 1 + below(80));
          text.insert(at, copy);
        }
      }
      if (text.empty()) text = " ";
    }
    accepted += parse(text) ? 1 : 0;
  }
  CHECK(accepted > 0);  // descriptions may hold almost anything
  CHECK(accepted < static_cast<std::size_t>(rounds) / 2);
}

}  // namespace generator_garbage_test
