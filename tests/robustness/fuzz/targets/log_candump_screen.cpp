// What candump shows on a terminal: whatever it is, it is read to its end; what is read can exist, and is
// written as a candump log and read again to the same.
#include <algorithm>

#include "ocm/log/candump_screen.hpp"

#include "tests/robustness/fuzz/log_rewrite.hpp"

using namespace ocm;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::rewrite<log::CandumpScreenReader, log::CandumpNanoWriter, log::CandumpReader>(
      fuzz::text_of(data, size), [](log::Entry& entry, const log::Losses& lost) {
        // -t A knows times before 1970, and a candump log none.
        if (lost.count(log::Lost::time) != 0) entry.time = std::max(entry.time, base::Time{});
      });
  return 0;
}
