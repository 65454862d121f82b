/// Fails on purpose: more memory than there is.
#include <vector>

#include <catch2/catch.hpp>

TEST_CASE("takes all memory") {
  std::vector<int> words(16'000'000, 1);
  CHECK(words.back() == 1);
}
