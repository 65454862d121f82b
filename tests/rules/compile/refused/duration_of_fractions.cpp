// Nanoseconds are whole: half of one is not rounded silently.
// expect g++: conversion from
// expect clang++: no viable conversion from
#include "ocm/base/time.hpp"

#ifdef OCM_MUST_FAIL
constexpr ocm::base::Duration half = std::chrono::duration<double>{0.5};
#else
constexpr ocm::base::Duration half = std::chrono::milliseconds{500};
#endif
static_assert(half.count() == 500'000'000);
