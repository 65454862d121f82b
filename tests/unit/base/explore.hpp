/// How much a test explores, by what OCM_EXPLORE says and by how fast it runs.
#pragma once

#include <algorithm>
#include <cstdlib>

namespace ocm::test {

/// Compiled with sanitizers, which look at every line and not at figures, and take ten times as long.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool sanitized = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = false;
#endif
#else
inline constexpr bool sanitized = false;
#endif

/// An emulated processor, on which the host's result need only be seen again.
#ifdef __arm__
inline constexpr bool emulated = true;
#else
inline constexpr bool emulated = false;
#endif

/// Whether a program runs as fast as a host can: optimised, and neither of the above.
#ifdef __OPTIMIZE__
inline constexpr bool at_full_speed = !sanitized && !emulated;
#else
inline constexpr bool at_full_speed = false;
#endif

/// OCM_EXPLORE times a test's usual; unset, it is 1. With sanitizers and emulated a tenth of it, which takes
/// as long, and `least` where fewer would say little.
inline int explored(int usual, int least = 1) {
  const char* const text = std::getenv("OCM_EXPLORE");
  const int times = text == nullptr ? 1 : std::clamp(std::atoi(text), 1, 1000);
  return std::max(usual * times / (sanitized || emulated ? 10 : 1), least);
}

/// The step through a range that a host's test goes through one by one: emulated it takes so much larger
/// ones.
inline constexpr int coarser(int step) {
  return emulated ? step : 1;
}

}  // namespace ocm::test
