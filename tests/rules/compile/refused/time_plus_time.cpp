// Two moments have a distance, and no sum.
// expect g++: no match for 'operator+'
// expect clang++: invalid operands to binary expression
#include "ocm/base/time.hpp"

constexpr ocm::base::Time begin{std::chrono::seconds{1}};
constexpr ocm::base::Time end{std::chrono::seconds{3}};
#ifdef OCM_MUST_FAIL
constexpr auto span = end + begin;
#else
constexpr auto span = end - begin;
#endif
static_assert(span == std::chrono::seconds{2});
