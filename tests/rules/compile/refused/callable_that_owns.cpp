// A callable is copied byte by byte: what owns something cannot be.
// expect: capture references or plain values only
#include "ocm/base/inline_function.hpp"

struct Owner {
  Owner() = default;
  Owner(const Owner&) {}
  int number = 0;
};

int call(Owner& owner) {
#ifdef OCM_MUST_FAIL
  ocm::base::InlineFunction<int()> function{[owner] { return owner.number; }};
#else
  ocm::base::InlineFunction<int()> function{[&owner] { return owner.number; }};
#endif
  return function();
}
