#include "cli/words/suggestion.hpp"

#include <vector>

#include <catch2/catch.hpp>

namespace tool_words_suggestion_test {

using namespace ocm::cli::words;

TEST_CASE("the nearest known word is named") {
  const std::vector<std::string_view> known{"--seed",     "--speed", "--dry-run",
                                            "--priority", "--for",   "--json"};
  CHECK(nearest("--priorty", known) == "--priority");
  CHECK(nearest("--jsno", known) == "--json");   // neighbours exchanged
  CHECK(nearest("--sped", known) == "--speed");  // as near as --seed, but begins alike for longer
  CHECK(nearest("--sed", known) == "--seed");
  CHECK(nearest("--dry", known) == "--dry-run");
  CHECK(nearest("--s", known) == "");
  CHECK(nearest("--", known) == "");
  CHECK(nearest("--wat", known) == "");
  CHECK(nearest("", known) == "");
  const std::vector<std::string_view> alike{"record", "replay"};
  CHECK(nearest("rep", alike) == "replay");
  CHECK(nearest("re", alike) == "");
  CHECK(nearest("", {}) == "");
}

TEST_CASE(
    "a word of up to five letters may have one edit, a longer one two; the first of equally near ones is "
    "named") {
  const std::vector<std::string_view> known{"power", "motors"};
  CHECK(nearest("poxer", known) == "power");
  CHECK(nearest("poxxr", known) == "");
  CHECK(nearest("moxxrs", known) == "motors");
  CHECK(nearest("moxxxs", known) == "");
  const std::vector<std::string_view> equal{"bat", "hat"};
  CHECK(nearest("cat", equal) == "bat");
  // The beginning of a word: from three letters on.
  const std::vector<std::string_view> one{"odometry"};
  CHECK(nearest("odo", one) == "odometry");
  CHECK(nearest("od", one) == "");
}

TEST_CASE("without a near word all are listed") {
  const std::vector<std::string_view> known{"run", "map"};
  CHECK(suggestion("rnu", known) == "did you mean 'run'?");
  CHECK(suggestion("listen", known) == "one of: run, map");
}

}  // namespace tool_words_suggestion_test
