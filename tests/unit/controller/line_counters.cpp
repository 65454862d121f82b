#include "ocm/controller/line_counters.hpp"

#include <cstring>
#include <type_traits>

#include <catch2/catch.hpp>

using namespace ocm;

namespace {

static_assert(std::is_trivially_copyable_v<controller::LineCounters>);
// Numbers of 32 bits alone, so that an image can hand them on as they lie.
static_assert(sizeof(controller::LineCounters) % sizeof(std::uint32_t) == 0);
static_assert(alignof(controller::LineCounters) == alignof(std::uint32_t));

TEST_CASE("line counters: all begin at nothing", "[line_counters]") {
  const controller::LineCounters counters{};
  std::uint32_t numbers[sizeof counters / sizeof(std::uint32_t)];
  std::memcpy(numbers, &counters, sizeof counters);
  for (const std::uint32_t number : numbers) CHECK(number == 0);
}

}  // namespace
