// A handler takes what it is called with.
// expect g++: no matching function for call to
// expect clang++: no matching constructor for initialization
#include "ocm/base/inline_function.hpp"

void call() {
#ifdef OCM_MUST_FAIL
  ocm::base::InlineFunction<void(int)> function{[](const char*) {}};
#else
  ocm::base::InlineFunction<void(int)> function{[](int) {}};
#endif
  function(1);
}
