// What is said of words that a variable of the shell has left empty.
#include "cli/shared/misuse.hpp"

#include <string>
#include <vector>

#include <catch2/catch.hpp>

namespace tool_shared_misuse_test {

using namespace ocm;

TEST_CASE("misuse: an empty word or value is said, by the word that it stands behind") {
  const auto said = [](const std::vector<std::string>& words) {
    const auto misuse = cli::empty_word(words);
    if (!misuse) return std::string{"taken"};
    CHECK(misuse->remedy == "is a variable of the shell not set?");
    return misuse->what;
  };
  CHECK(said({"--bus", "", "list"}) == "an empty value for --bus");
  CHECK(said({"--bus=", "list"}) == "an empty value for --bus");
  CHECK(said({"listen", "-n", ""}) == "an empty value for -n");
  CHECK(said({""}) == "an empty word");
  CHECK(said({"info", ""}) == "an empty word behind 'info'");
  CHECK(said({"decode", "-", ""}) == "an empty word behind '-'");  // the standard input
  CHECK(said({"info", "", "--", ""}) == "an empty word behind 'info'");
  // Of several the first.
  CHECK(said({"--spec=", "--bus=", ""}) == "an empty value for --spec");
}

TEST_CASE("misuse: what has no empty word is taken, and whatever stands behind --") {
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{},
                                             {"list"},
                                             {"--bus", "sim", "list"},
                                             {"--bus=sim", "list"},
                                             {"--spec=a=", "list"},  // a value that ends so
                                             {"set", "motors", "x="},
                                             {"info", "--", ""},
                                             {"--", "--bus="}}) {
    CAPTURE(words);
    CHECK_FALSE(cli::empty_word(words).has_value());
  }
}

}  // namespace tool_shared_misuse_test
