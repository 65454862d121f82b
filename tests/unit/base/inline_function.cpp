#include "ocm/base/inline_function.hpp"

#include <memory>
#include <type_traits>

#include <catch2/catch.hpp>

namespace base_inline_function_test {

using ocm::base::InlineFunction;

int twice(int x) {
  return 2 * x;
}

TEST_CASE("an empty function says so") {
  InlineFunction<int(int)> f;
  CHECK_FALSE(static_cast<bool>(f));
  f = twice;
  CHECK(static_cast<bool>(f));
  CHECK(f(21) == 42);
}

TEST_CASE("captured references reach their objects, also through a copy") {
  int calls = 0;
  int last = 0;
  InlineFunction<void(int)> f = [&calls, &last](int x) { ++calls, last = x; };
  f(5);
  InlineFunction<void(int)> copy = f;
  copy(6);
  CHECK(calls == 2);
  CHECK(last == 6);
  f = InlineFunction<void(int)>{};
  CHECK_FALSE(static_cast<bool>(f));
  copy(7);
  CHECK(last == 7);
}

TEST_CASE("captured values are the function's own: a copy counts for itself") {
  InlineFunction<int()> f = [n = 0]() mutable { return ++n; };
  CHECK(f() == 1);
  InlineFunction<int()> copy = f;
  CHECK(f() == 2);
  CHECK(f() == 3);
  CHECK(copy() == 2);
}

TEST_CASE("arguments pass through: references, moved objects, conversions of the result") {
  InlineFunction<void(int&)> increase = [](int& x) { ++x; };
  int x = 1;
  increase(x);
  CHECK(x == 2);
  InlineFunction<int(std::unique_ptr<int>)> open = [](std::unique_ptr<int> p) { return *p; };
  CHECK(open(std::make_unique<int>(9)) == 9);
  InlineFunction<long(short)> wider = [](int y) { return y + 1; };
  CHECK(wider(short{1}) == 2L);
}

TEST_CASE("more room may be asked for, and nothing else is kept than the callable and its caller") {
  struct Four {
    void* p[4];
  };
  InlineFunction<bool(), sizeof(Four)> f = [four = Four{}] { return four.p[3] == nullptr; };
  CHECK(f());
  STATIC_REQUIRE(sizeof(InlineFunction<void()>) == 3 * sizeof(void*));
  STATIC_REQUIRE(std::is_trivially_copyable_v<InlineFunction<void()>>);
}

TEST_CASE("what cannot be called in that way is not taken") {
  STATIC_REQUIRE(std::is_constructible_v<InlineFunction<int(int)>, int (*)(int)>);
  STATIC_REQUIRE_FALSE(std::is_constructible_v<InlineFunction<int(int)>, int (*)(int, int)>);
  STATIC_REQUIRE_FALSE(std::is_constructible_v<InlineFunction<int*(int)>, int (*)(int)>);
  STATIC_REQUIRE_FALSE(std::is_constructible_v<InlineFunction<int(int)>, int>);
}

}  // namespace base_inline_function_test
