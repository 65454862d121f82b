#include "ocm/analysis/verdict.hpp"

#include <set>
#include <string_view>

#include <catch2/catch.hpp>

namespace analysis_verdict_test {

using namespace ocm::analysis;

// Twenty million terms, of 10 ns each on a host: a fifth of a second.
static_assert(Limits{}.terms == 20'000'000);
static_assert(!Explained{}.ok() && !Explained{}.bounded() && Explained{}.reason == Reason::bad_input);
static_assert(Explained{.response = 7, .deadline = 10, .reason = Reason::schedulable}.slack() == 3);
static_assert(Explained{.response = 17, .deadline = 10, .reason = Reason::misses_deadline}.slack() == -7);
static_assert(!Explained{.response = 17, .deadline = 10, .reason = Reason::misses_deadline}.ok());

TEST_CASE("every reason has words of its own") {
  std::set<std::string_view> words;
  for (int i = 0; i <= static_cast<int>(Reason::bad_input); ++i) {
    const std::string_view text = describe(static_cast<Reason>(i));
    CHECK_FALSE(text.empty());
    CHECK(text.find("unknown") == text.npos);
    CHECK(words.insert(text).second);
  }
  CHECK(describe(static_cast<Reason>(200)) == "unknown reason");
}

}  // namespace analysis_verdict_test
