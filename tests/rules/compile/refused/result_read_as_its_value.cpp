// A result is opened before its value is used.
// expect g++: conversion from
// expect clang++: no viable conversion from
#include "ocm/protocol/request.hpp"

using namespace std::chrono_literals;

#ifdef OCM_MUST_FAIL
constexpr ocm::protocol::Period period = ocm::protocol::Period::from(500ms);
#else
constexpr ocm::protocol::Period period = ocm::protocol::Period::from(500ms).value;
#endif
static_assert(period.duration() == 500ms);
