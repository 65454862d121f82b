#include "ocm/log/complaints.hpp"

#include <catch2/catch.hpp>

namespace log_complaints_test {

using namespace ocm::log;

TEST_CASE("complaints are counted by cause, and the first are kept in words") {
  Complaints complaints;
  for (std::uint64_t i = 1; i <= 20; ++i) complaints.add(Cause::syntax, {i, true}, "x");
  complaints.add(Cause::length, {4096, false}, "y");
  CHECK(complaints.count(Cause::syntax) == 20);
  CHECK(complaints.count(Cause::length) == 1);
  CHECK(complaints.count(Cause::time) == 0);
  CHECK(complaints.total() == 21);
  static_assert(Complaints::kept == 8);
  REQUIRE(complaints.first().size() == 8);
  CHECK(complaints.first()[2].place == Place{3, true});
}

TEST_CASE("what is shown of a log cannot command a terminal, and is short") {
  CHECK(Complaints::printable("a\x1B[2Jb\xFF") == "a?[2Jb?");
  CHECK(Complaints::printable("\x1F !}~\x7F") == "? !}~?");
  CHECK(Complaints::printable(std::string(61, 'x')) == std::string(60, 'x') + "...");
  CHECK(Complaints::printable(std::string(60, 'x')) == std::string(60, 'x'));
}

static_assert(Place{} == Place{0, false} && Place{5} == Place{5, false});

TEST_CASE("each cause has its words, and a place says what it counts") {
  for (std::size_t i = 0; i < causes; ++i)
    for (std::size_t j = 0; j < i; ++j)
      CHECK(describe(static_cast<Cause>(i)) != describe(static_cast<Cause>(j)));
  CHECK(to_text(Place{12, true}) == "line 12");
  CHECK(to_text(Place{4096, false}) == "byte 4096");
}

}  // namespace log_complaints_test
