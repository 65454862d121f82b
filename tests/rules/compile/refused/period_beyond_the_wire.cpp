// The wire counts a period with 16 bits.
// expect g++: narrowing conversion of '100000'
// expect clang++: constant expression evaluates to 100000 which cannot be narrowed
#include "ocm/protocol/request.hpp"

using namespace ocm::protocol;

#ifdef OCM_MUST_FAIL
constexpr Period period{100'000, PeriodUnit::microseconds};
#else
constexpr Period period{100, PeriodUnit::milliseconds};
#endif
static_assert(period.duration().count() == 100'000'000);
