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

}  // namespace ocm::test
