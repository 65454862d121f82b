// A candump log: whatever it is, it is read to its end; what is read can exist, and is written and read again
// to the same. The fast path and the careful one are compared line by line in tests/unit/log.
#include "ocm/log/candump.hpp"

#include "tests/robustness/fuzz/log_rewrite.hpp"

using namespace ocm;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::rewrite<log::CandumpReader, log::CandumpNanoWriter>(fuzz::text_of(data, size),
                                                            [](log::Entry&, const log::Losses&) {});
  return 0;
}
