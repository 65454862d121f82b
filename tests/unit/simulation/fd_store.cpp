#include "ocm/simulation/fd_store.hpp"

#include <map>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"

namespace simulation_fd_store_test {

using namespace ocm;
using simulation::FdStore;

TEST_CASE("every frame that is kept is there under its number, and places are used again") {
  ocm::test::Random random{64};
  FdStore store;
  std::map<std::uint32_t, can::AnyFrame> expected;
  std::size_t most = 0;
  std::uint32_t highest = 0;
  for (std::uint32_t i = 0; i < 20'000; ++i) {
    if (expected.empty() || (expected.size() < 50 && random.below(2) == 0)) {
      can::AnyFrame frame;
      frame.id = i;
      const std::uint32_t number = store.keep(frame);
      REQUIRE(number != 0);
      REQUIRE(expected.emplace(number, frame).second);
      highest = std::max(highest, number);
      most = std::max(most, expected.size());
    } else {
      auto one = expected.begin();
      std::advance(one, random.below(static_cast<std::uint32_t>(expected.size())));
      store.release(one->first);
      expected.erase(one);
    }
    store.release(0);  // a classic frame, which has none
    REQUIRE(store.size() == expected.size());
    for (const auto& [number, frame] : expected) REQUIRE(store[number] == frame);
  }
  CHECK(highest == most);
}

}  // namespace simulation_fd_store_test
