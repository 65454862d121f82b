// A board has no heap for what a lambda drags along.
// expect: capture less: the callable does not fit into its place
#include "ocm/base/inline_function.hpp"

struct Large {
  long numbers[8] = {};
};

int call(Large& large) {
#ifdef OCM_MUST_FAIL
  ocm::base::InlineFunction<int()> function{[large] { return static_cast<int>(large.numbers[0]); }};
#else
  ocm::base::InlineFunction<int()> function{[&large] { return static_cast<int>(large.numbers[0]); }};
#endif
  return function();
}
