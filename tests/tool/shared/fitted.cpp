#include "cli/shared/fitted.hpp"

#include <catch2/catch.hpp>

namespace tool_shared_fitted_test {

using ocm::cli::fitted;

TEST_CASE("each line is broken by itself, and a text ends as it did", "[folding]") {
  CHECK(fitted("", 10, 2).empty());
  CHECK(fitted("one", 10, 2) == "one");
  CHECK(fitted("one\n", 10, 2) == "one\n");
  CHECK(fitted("\n\none\n\n", 10, 2) == "\n\none\n\n");
  CHECK(fitted("one two three\nfour", 9, 0) == "one two\nthree\nfour");
  CHECK(fitted("one two three four five six seven eight\nnine", 30, 4) ==
        "one two three four five six\n    seven eight\nnine");
  CHECK(fitted("one two three\nfour\n", 9, 0) == "one two\nthree\nfour\n");
}

}  // namespace tool_shared_fitted_test
