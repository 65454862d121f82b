#include "ocm/base/result.hpp"

#include <set>
#include <string>

#include <catch2/catch.hpp>

namespace base_result_test {

using ocm::base::Error;
using ocm::base::Result;
using ocm::base::Status;

constexpr Error last_error = Error::not_schedulable;

struct NoDefaultComparison {
  int number = 0;
};

TEST_CASE("a result is a value or an error") {
  constexpr Result<int> good{7};
  STATIC_REQUIRE(good.ok());
  STATIC_REQUIRE(static_cast<bool>(good));
  STATIC_REQUIRE(*good == 7);
  STATIC_REQUIRE(good.error == Error::none);

  constexpr Result<int> bad{Error::full};
  STATIC_REQUIRE_FALSE(bad.ok());
  STATIC_REQUIRE_FALSE(static_cast<bool>(bad));
  STATIC_REQUIRE(bad.error == Error::full);

  // Zero is a value, not an error.
  STATIC_REQUIRE(Result<int>{0}.ok());
  STATIC_REQUIRE(Result<bool>{false}.ok());
}

TEST_CASE("results compare as values") {
  STATIC_REQUIRE(Result<int>{7} == Result<int>{7});
  STATIC_REQUIRE_FALSE(Result<int>{7} == Result<int>{8});
  STATIC_REQUIRE_FALSE(Result<int>{0} == Result<int>{Error::full});
  STATIC_REQUIRE_FALSE(Result<int>{Error::closed} == Result<int>{Error::full});
  STATIC_REQUIRE(Status{} == Status{Error::none});
  STATIC_REQUIRE_FALSE(Status{} == Status{Error::timed_out});
}

TEST_CASE("a result's members can be reached and changed through it") {
  Result<std::string> text{std::string{"abc"}};
  CHECK(text->size() == 3);
  *text += 'd';
  text->push_back('e');
  CHECK(text.value == "abcde");
  // A type that cannot be compared can still be a result.
  CHECK(Result<NoDefaultComparison> {
    NoDefaultComparison {
      3
    }
  } -> number == 3);
}

TEST_CASE("a result may carry another kind of error") {
  enum class Weather { fine, storm };
  using Forecast = Result<int, Weather>;
  STATIC_REQUIRE(Forecast{1}.ok());
  STATIC_REQUIRE(Forecast{Weather::fine}.ok());
  STATIC_REQUIRE_FALSE(Forecast{Weather::storm}.ok());
  STATIC_REQUIRE_FALSE(Result<void, Weather>{Weather::storm}.ok());
}

TEST_CASE("every error has words of its own") {
  std::set<std::string_view> words;
  for (int i = 0; i <= static_cast<int>(last_error); ++i) {
    const auto text = ocm::base::describe(static_cast<Error>(i));
    CHECK(text != "unknown error");
    CHECK(words.insert(text).second);
  }
  CHECK(ocm::base::describe(static_cast<Error>(static_cast<int>(last_error) + 1)) == "unknown error");
}

TEST_CASE("a result costs its value and the error") {
  STATIC_REQUIRE(sizeof(Status) == 1);
  STATIC_REQUIRE(sizeof(Result<std::uint32_t>) == 8);
}

}  // namespace base_result_test
