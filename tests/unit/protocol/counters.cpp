#include "ocm/protocol/counters.hpp"

#include <cstring>
#include <set>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

namespace protocol_counters_test {

using ocm::base::Error;
using ocm::protocol::Counters;

TEST_CASE("every counter is reported, once and by its own name") {
  // The counters are nothing but 32-bit numbers: number them, and see whether all come out in order.
  Counters counters;
  constexpr std::size_t count = sizeof(Counters) / sizeof(std::uint32_t);
  std::uint32_t numbers[count];
  for (std::size_t i = 0; i < count; ++i) numbers[i] = static_cast<std::uint32_t>(i + 1);
  std::memcpy(static_cast<void*>(&counters), numbers, sizeof counters);

  std::vector<std::uint32_t> told;
  std::set<std::string> names;
  for_each(counters, [&](std::string_view name, std::uint32_t value) {
    told.push_back(value);
    CHECK(names.emplace(name).second);
  });
  CHECK(told == std::vector<std::uint32_t>(numbers, numbers + count));
}

TEST_CASE("every counter begins at zero") {
  for_each(Counters{}, [](std::string_view name, std::uint32_t value) {
    INFO(name);
    CHECK(value == 0);
  });
}

TEST_CASE("a refusal is counted under its cause") {
  struct Case {
    Error cause;
    std::uint32_t Counters::*counter;
  };
  for (const auto& [cause, counter] :
       {Case{Error::bad_length, &Counters::bad_length}, Case{Error::bad_mode, &Counters::bad_mode},
        Case{Error::bad_unit, &Counters::bad_unit}, Case{Error::bad_period, &Counters::bad_period},
        Case{Error::unknown_topic, &Counters::not_served},
        Case{Error::not_schedulable, &Counters::not_schedulable},
        Case{Error::no_answer, &Counters::failed}}) {
    Counters counters;
    counters.refuse(cause);
    Counters expected;
    expected.*counter = 1;
    CHECK(counters == expected);
    CHECK(counters.refused() == 1);
  }
}

TEST_CASE("refused is the sum of its causes and of nothing else") {
  Counters counters;
  for (int i = 0; i < 2; ++i)
    for (const auto cause :
         {Error::bad_length, Error::bad_mode, Error::bad_unit, Error::bad_period, Error::unknown_topic})
      counters.refuse(cause);
  CHECK(counters.refused() == 10);
  counters.received = 100;
  counters.foreign = 100;
  counters.late = 100;
  counters.timeouts = 100;
  CHECK(counters.refused() == 10);
}

TEST_CASE("counters wrap") {
  Counters counters;
  counters.bad_mode = UINT32_MAX;
  counters.refuse(Error::bad_mode);
  CHECK(counters.bad_mode == 0);
}

}  // namespace protocol_counters_test
