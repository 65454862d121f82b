// A binary fraction is not the decimal that was written: 0.0175 is 175 * 10^-4.
// expect g++: narrowing conversion of
// expect clang++: cannot be narrowed to 'std::int64_t'
#include "ocm/base/decimal.hpp"

#ifdef OCM_MUST_FAIL
constexpr ocm::base::Decimal scale{0.0175};
#else
constexpr ocm::base::Decimal scale{175, -4};
#endif
static_assert(scale.as_double() == 0.0175);
