// A pcap file: whatever it is, it is read to its end, or to where no record can follow; what is read can
// exist, and is written and read again to the same, but for what the format has no room for.
#include "ocm/log/pcap.hpp"

#include "tests/robustness/fuzz/log_rewrite.hpp"

using namespace ocm;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::rewrite<log::PcapReader, log::PcapWriter>(fuzz::text_of(data, size),
                                                  [](log::Entry& entry, const log::Losses& lost) {
                                                    if (lost.count(log::Lost::direction) != 0)
                                                      entry.direction = log::Direction::unknown;
                                                  });
  return 0;
}
