#include "ocm/mapper/app/counters.hpp"

#include <cstring>
#include <type_traits>

#include <catch2/catch.hpp>

namespace mapper_app_counters_test {

using namespace ocm;

static_assert(std::is_trivially_copyable_v<mapper::app::Counters>);
// Numbers of 32 bits alone, so that an image can hand them on as they lie.
static_assert(sizeof(mapper::app::Counters) % sizeof(std::uint32_t) == 0);
static_assert(alignof(mapper::app::Counters) == alignof(std::uint32_t));

TEST_CASE("mapper counters: all begin at nothing", "[mapper_counters]") {
  const mapper::app::Counters counters{};
  std::uint32_t numbers[sizeof counters / sizeof(std::uint32_t)];
  std::memcpy(numbers, &counters, sizeof counters);
  for (const std::uint32_t number : numbers) CHECK(number == 0);
}

}  // namespace mapper_app_counters_test
