#include "cli/words/suggestion.hpp"

#include <vector>

#include <catch2/catch.hpp>

namespace tool_words_suggestion_test {

using namespace ocm;
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
  const std::vector<std::string_view> cases{"ESP_E", "ESP_STATUS", "ESP_Status"};
  CHECK(nearest("esp_status", cases) == "ESP_STATUS");
  CHECK(nearest("esp_e", cases) == "ESP_E");
  // From A to Z, and nothing beside them: '`' and '{' are 32 behind '@' and '['.
  const std::vector<std::string_view> letters{"buzz", "alpaca", "`{`{"};
  CHECK(nearest("BUZZ", letters) == "buzz");
  CHECK(nearest("ALPACA", letters) == "alpaca");
  CHECK(nearest("@[@[", letters) == "");
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

TEST_CASE("a bounded edit distance is the whole one, or one more than the bound") {
  // All words of up to four letters out of three, and the plain definition beside it.
  std::vector<std::string> all{""};
  for (std::size_t i = 0; all[i].size() < 4; ++i)
    for (const char letter : {'a', 'b', 'c'}) all.push_back(all[i] + letter);
  const auto plain = [](const std::string& a, const std::string& b) {
    std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i)
      for (std::size_t j = 0; j <= b.size(); ++j) {
        if (i == 0 || j == 0) {
          d[i][j] = i + j;
          continue;
        }
        d[i][j] =
            std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
        if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
          d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
      }
    return d[a.size()][b.size()];
  };
  std::size_t wrong = 0;
  for (const auto& a : all)
    for (const auto& b : all) {
      const std::size_t whole = plain(a, b);
      for (std::size_t most = 0; most < 5; ++most)
        if (spec::edit_distance(a, b, most) != std::min(whole, most + 1)) ++wrong;
    }
  CHECK(wrong == 0);
  const std::string longer(70, 'x');
  CHECK(spec::edit_distance(longer, longer + "y", 100) == 0);  // of the first 64
  CHECK(spec::edit_distance(longer, "", 100) == 64);
  CHECK(spec::edit_distance(longer, std::string(64, 'y'), 64) == 64);
}

TEST_CASE("without a near word all are listed") {
  const std::vector<std::string_view> known{"run", "map"};
  CHECK(suggestion("rnu", known) == "did you mean 'run'?");
  CHECK(suggestion("listen", known) == "one of: run, map");
}

}  // namespace tool_words_suggestion_test
