// A classic frame has eight bytes.
// expect g++: too many initializers for
// expect clang++: excess elements in struct initializer
#include "ocm/can/frame.hpp"

#ifdef OCM_MUST_FAIL
constexpr ocm::can::Frame frame{0x123, 8, {1, 2, 3, 4, 5, 6, 7, 8, 9}};
#else
constexpr ocm::can::Frame frame{0x123, 8, {1, 2, 3, 4, 5, 6, 7, 8}};
#endif
static_assert(frame.data[7] == 8);
