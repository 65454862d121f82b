#include "ocm/reflective/monitor.hpp"

#include <array>
#include <chrono>
#include <random>
#include <vector>

#include <catch2/catch.hpp>

namespace reflective_monitor_test {

using namespace ocm;
using namespace ocm::reflective;
using namespace std::chrono_literals;

constexpr Condition above{.is = Is::above, .limit = 10, .hysteresis = 3};
static_assert(!holds(above, 10, false) && holds(above, 11, false));
static_assert(holds(above, 8, true) && !holds(above, 7, true));
constexpr Condition below{.is = Is::below, .limit = 10, .hysteresis = 3};
static_assert(!holds(below, 10, false) && holds(below, 9, false));
static_assert(holds(below, 12, true) && !holds(below, 13, true));
constexpr Condition age{.watched = Watched::age, .is = Is::above, .limit = 10};
static_assert(holds(age, 10, false) && !holds(age, 9, true));
constexpr Condition bits{.is = Is::any_bit, .limit = 6};
static_assert(holds(bits, 2, false) && holds(bits, 4, false) && !holds(bits, 9, true));
static_assert(holds({.is = Is::equal, .limit = 3}, 3, false) &&
              !holds({.is = Is::equal, .limit = 3}, 4, false));
static_assert(!holds({.is = Is::other, .limit = 3}, 3, false) &&
              holds({.is = Is::other, .limit = 3}, 4, false));

constexpr Term a{.condition = 0};
constexpr Term b{.condition = 1};
constexpr Term all{.op = Op::all};
constexpr Term any{.op = Op::any};
constexpr Term negation{.op = Op::negation};

TEST_CASE("monitor: an expression must be whole") {
  const auto whole = [](std::vector<Term> terms) { return well_formed(terms, 2); };
  CHECK(whole({a}));
  CHECK(whole({a, b, all}));
  CHECK(whole({a, negation, b, any}));
  CHECK_FALSE(whole({}));
  CHECK_FALSE(whole({all}));
  CHECK_FALSE(whole({a, all}));
  CHECK_FALSE(whole({negation}));
  CHECK_FALSE(whole({a, b}));
  CHECK_FALSE(whole({{.condition = 2}}));
  std::vector<Term> deep(most_operands, a);
  deep.resize(2 * most_operands - 1, all);
  CHECK(well_formed(deep, 1));
  deep.insert(deep.begin(), a);
  deep.push_back(all);
  CHECK_FALSE(well_formed(deep, 1));
}

TEST_CASE("monitor: what counts inverted") {
  const auto inverted = [](std::vector<Term> terms) {
    std::vector<bool> found;
    for (std::size_t i = 0; i < terms.size(); ++i)
      if (terms[i].op == Op::condition) found.push_back(negated(terms, i));
    return found;
  };
  using Each = std::vector<bool>;
  CHECK(inverted({a}) == Each{false});
  CHECK(inverted({a, negation}) == Each{true});
  CHECK(inverted({a, negation, negation}) == Each{false});
  CHECK(inverted({a, negation, b, any}) == Each{true, false});
  CHECK(inverted({a, b, negation, any}) == Each{false, true});
  CHECK(inverted({a, b, any, negation}) == Each{true, true});
  CHECK(inverted({a, b, negation, all, negation}) == Each{true, false});
  CHECK(inverted({a, b, a, any, negation, all, b, negation, any}) == Each{false, true, true, true});
}

TEST_CASE("monitor: and, or, not of what may be unknown, by Kleene's tables") {
  using enum Truth;
  const auto value = [](std::vector<Term> terms, Truth x, Truth y) {
    return evaluate(terms, [&](std::size_t c) { return c == 0 ? x : y; });
  };
  // An order no < unknown < yes: and is the least, or the greatest.
  const auto rank = [](Truth t) { return t == no ? 0 : t == unknown ? 1 : 2; };
  for (const Truth x : {unknown, no, yes}) {
    CHECK(rank(value({a, negation}, x, no)) == 2 - rank(x));
    for (const Truth y : {unknown, no, yes}) {
      CHECK(rank(value({a, b, all}, x, y)) == std::min(rank(x), rank(y)));
      CHECK(rank(value({a, b, any}, x, y)) == std::max(rank(x), rank(y)));
      // De Morgan
      CHECK(value({a, b, all, negation}, x, y) == value({a, negation, b, negation, any}, x, y));
    }
  }
}

/// An expression as a tree, to judge the one on two stacks of bits.
struct Tree {
  std::vector<Term> terms;
  Truth value = Truth::unknown;
};
Tree random_tree(std::mt19937& random, const std::vector<Truth>& values, int depth) {
  if (depth == 0 || random() % 4 == 0) {
    const auto c = static_cast<std::uint16_t>(random() % values.size());
    return {{{.condition = c}}, values[c]};
  }
  Tree left = random_tree(random, values, depth - 1);
  if (random() % 4 == 0) {
    left.terms.push_back(negation);
    return {left.terms, !left.value};
  }
  const Tree right = random_tree(random, values, depth - 1);
  const bool conjunction = random() % 2 == 0;
  left.terms.insert(left.terms.end(), right.terms.begin(), right.terms.end());
  left.terms.push_back(conjunction ? all : any);
  return {left.terms, conjunction ? both(left.value, right.value) : either(left.value, right.value)};
}
TEST_CASE("monitor: random expressions have the value of their trees") {
  std::mt19937 random{7};
  int of[3] = {};
  for (int run = 0; run < 20'000; ++run) {
    std::vector<Truth> values(1 + random() % 5);
    for (Truth& value : values) value = static_cast<Truth>(random() % 3);
    const Tree tree = random_tree(random, values, 6);
    if (!well_formed(tree.terms, values.size())) FAIL("not whole");
    const Truth found = evaluate(tree.terms, [&](std::size_t c) { return values[c]; });
    if (found != tree.value) FAIL("run " << run);
    ++of[static_cast<int>(found)];
  }
  for (const int count : of) CHECK(count > 1000);
}

TEST_CASE("monitor: it lasts only without a break") {
  const base::Time start{1s};
  Since since;
  CHECK(since.fires_at(10ms) == base::never);
  since.take(Truth::yes, start);
  since.take(Truth::yes, start + 5ms);
  CHECK(since.fires_at(10ms) == start + 10ms);
  since.take(Truth::unknown, start + 6ms);
  CHECK(since.fires_at(0ms) == base::never);
  since.take(Truth::yes, start + 7ms);
  CHECK(since.fires_at(10ms) == start + 17ms);
  since.take(Truth::no, start + 8ms);
  CHECK(since.fires_at(10ms) == base::never);
}

}  // namespace reflective_monitor_test
