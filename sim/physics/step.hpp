/// The step in which worlds go on: every body, motor and servo moves once in it.
#pragma once

#include <chrono>
#include <cstdint>

#include "ocm/base/time.hpp"

namespace ocm::sim {

inline constexpr base::Duration step_length = std::chrono::milliseconds{1};
inline constexpr double step_s = 0.001;
static_assert(base::Duration{static_cast<std::int64_t>(step_s * 1e9)} == step_length);

}  // namespace ocm::sim
