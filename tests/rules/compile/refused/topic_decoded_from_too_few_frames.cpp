// A sample of three frames is decoded from three.
// expect g++: cannot convert 'std::array<
// expect clang++: no viable conversion from 'array<
#include "ocm/topics/amiro.hpp"

using ocm::can::Payload;

#ifdef OCM_MUST_FAIL
constexpr auto sample = amiro::Magnetometer::decode(std::array<Payload, 2>{});
#else
constexpr auto sample = amiro::Magnetometer::decode(std::array<Payload, 3>{});
#endif
static_assert(sample == amiro::Magnetometer{});
