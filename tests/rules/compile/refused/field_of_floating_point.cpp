// Fields are whole numbers; the spec's scale makes them physical.
// expect g++: std::is_integral_v<T>
// expect clang++: std::is_integral_v<float>
#include "ocm/protocol/codec.hpp"

#ifdef OCM_MUST_FAIL
using Field = ocm::protocol::Bits<float, 0>;
#else
using Field = ocm::protocol::Bits<std::int32_t, 0>;
#endif
static_assert(Field::position.width == 32);
