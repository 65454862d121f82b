#include "ocm/can/filter.hpp"

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"

namespace can_filter_test {

using ocm::can::Filter;
using ocm::can::Format;
using ocm::can::Frame;

TEST_CASE("a mask of zero accepts every base data frame") {
  for (std::uint32_t id = 0; id <= ocm::can::max_base_id; ++id) REQUIRE(Filter{}.accepts({id, 0, {}}));
}

TEST_CASE("a full mask accepts one identifier") {
  constexpr Filter filter{0x605, 0x7FF};
  for (std::uint32_t id = 0; id <= ocm::can::max_base_id; ++id)
    REQUIRE(filter.accepts({id, 0, {}}) == (id == 0x605));
}

TEST_CASE("the bits outside of the mask do not matter, in the filter or in the frame") {
  // A topic's requests at every priority: C/S 0, any priority, topic 5.
  constexpr Filter requests{0x305, 0x4FF};
  STATIC_REQUIRE(requests.accepts({0x005, 1, {}}));
  STATIC_REQUIRE(requests.accepts({0x205, 1, {}}));
  STATIC_REQUIRE_FALSE(requests.accepts({0x605, 1, {}}));
  STATIC_REQUIRE_FALSE(requests.accepts({0x206, 1, {}}));

  ocm::test::Random random{1};
  for (int i = 0; i < 20'000; ++i) {
    const Filter filter{random() & 0x7FF, random() & 0x7FF};
    const std::uint32_t id = random.below(2) == 0 ? random() & 0x7FF : filter.id ^ 1U << random.below(11);
    bool expected = true;
    for (unsigned bit = 0; bit < 11; ++bit)
      if ((filter.mask >> bit & 1) != 0 && (id >> bit & 1) != (filter.id >> bit & 1)) expected = false;
    REQUIRE(filter.accepts({id, 0, {}}) == expected);
  }
}

TEST_CASE("nothing but base data frames is accepted") {
  for (const Format format : {Format::extended, Format::base_remote, Format::extended_remote, Format::error})
    CHECK_FALSE(Filter{}.accepts({0x205, 0, {}, format}));
}

}  // namespace can_filter_test
