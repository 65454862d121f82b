// A pcapng file: whatever it is, it is read to its end, around damage; what is read can exist, and is written
// and read again to the same.
#include "ocm/log/pcapng.hpp"

#include "tests/robustness/fuzz/log_rewrite.hpp"

using namespace ocm;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::rewrite<log::PcapngReader, log::PcapngWriter>(fuzz::text_of(data, size),
                                                      [](log::Entry& entry, const log::Losses& lost) {
                                                        if (lost.count(log::Lost::time) != 0)
                                                          entry.time = std::max(entry.time, base::Time{});
                                                      });
  return 0;
}
