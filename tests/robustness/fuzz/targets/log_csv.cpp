// A log in comma-separated values: whatever it is, it is read to its end; what is read can exist, and is
// written and read again to the same.
#include "ocm/log/csv.hpp"

#include "tests/robustness/fuzz/log_rewrite.hpp"

using namespace ocm;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::rewrite<log::CsvReader, log::CsvWriter>(fuzz::text_of(data, size),
                                                [](log::Entry&, const log::Losses&) {});
  return 0;
}
