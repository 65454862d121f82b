#include "ocm/base/fixed_vector.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"

namespace base_fixed_vector_test {

using ocm::base::Error;
using ocm::base::FixedVector;

template <std::size_t N>
bool equal(const FixedVector<int, N>& a, const std::vector<int>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end());
}

constexpr int sum_of_two() {
  FixedVector<int, 2> v;
  (void)v.push_back(40);
  (void)v.push_back(2);
  int sum = 0;
  for (const int i : v) sum += i;
  return sum;
}
static_assert(sum_of_two() == 42);

TEST_CASE("a full vector refuses, and keeps what it has") {
  FixedVector<int, 2> v;
  CHECK(v.empty());
  CHECK_FALSE(v.full());
  CHECK(v.push_back(1).ok());
  CHECK(v.push_back(2).ok());
  CHECK(v.full());
  CHECK(v.push_back(3).error == Error::full);
  CHECK(equal(v, {1, 2}));
  v.clear();
  CHECK(v.empty());
  CHECK(v.push_back(4).ok());
  CHECK(equal(v, {4}));
  STATIC_REQUIRE(FixedVector<int, 2>::capacity() == 2);
}

TEST_CASE("a vector without room takes nothing") {
  FixedVector<int, 0> v;
  CHECK(v.empty());
  CHECK(v.full());
  CHECK(v.push_back(1).error == Error::full);
  CHECK(v.begin() == v.end());
}

TEST_CASE("erase takes one element and keeps the order; beyond the end it takes nothing") {
  FixedVector<int, 4> v;
  for (const int i : {1, 2, 3, 4}) REQUIRE(v.push_back(i).ok());
  v.erase(1);
  CHECK(equal(v, {1, 3, 4}));
  v.erase(2);
  CHECK(equal(v, {1, 3}));
  v.erase(2);
  v.erase(SIZE_MAX);  // index + 1 is 0
  CHECK(equal(v, {1, 3}));
  v.erase(0);
  v.erase(0);
  CHECK(v.empty());
  v.erase(0);
  CHECK(v.empty());
}

TEST_CASE("it behaves as std::vector does, up to its capacity") {
  ocm::test::Random random{1};
  FixedVector<int, 7> ours;
  std::vector<int> theirs;
  for (int step = 0; step < 20'000; ++step) {
    const auto dice = random() % 16;
    if (dice < 9) {
      CHECK(ours.push_back(step).ok() == (theirs.size() < 7));
      if (theirs.size() < 7) theirs.push_back(step);
    } else if (dice < 15 && !theirs.empty()) {
      const std::size_t at = random() % theirs.size();
      ours.erase(at);
      theirs.erase(theirs.begin() + static_cast<std::ptrdiff_t>(at));
    } else if (random() % 8 == 0) {
      ours.clear();
      theirs.clear();
    }
    REQUIRE(equal(ours, theirs));
  }
}

}  // namespace base_fixed_vector_test
