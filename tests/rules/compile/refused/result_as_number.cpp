// A result is true or false when asked, and no number.
// expect g++: cannot convert
// expect clang++: no viable conversion from
#include "ocm/base/text.hpp"

#ifdef OCM_MUST_FAIL
constexpr bool known = ocm::base::parse_unsigned("12");
#else
constexpr bool known = ocm::base::parse_unsigned("12").ok();
#endif
static_assert(known);
