/// How much a test with random inputs explores: OCM_EXPLORE times its usual. scripts/test sets it; unset, it
/// is 1.
#pragma once

#include <algorithm>
#include <cstdlib>

namespace ocm::test {

inline int explored(int usual) {
  const char* const text = std::getenv("OCM_EXPLORE");
  return text == nullptr ? usual : usual * std::clamp(std::atoi(text), 1, 1000);
}

/// The step through a range that a host's test goes through one by one: an emulated board, on which the
/// host's result need only be seen again, takes so much larger ones.
#ifdef __arm__
inline constexpr int coarser(int step) {
  return step;
}
#else
inline constexpr int coarser(int) {
  return 1;
}
#endif

}  // namespace ocm::test
