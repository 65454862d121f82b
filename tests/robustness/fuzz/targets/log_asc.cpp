// A log of Vector's in text: whatever it is, it is read to its end; what is read can exist, and is written
// and read again to the same, but for digits of the time and times before the first, which are counted.
#include "ocm/log/asc.hpp"

#include "tests/robustness/fuzz/log_rewrite.hpp"

using namespace ocm;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzz::text_of(data, size);
  base::Time first = base::never;
  fuzz::rewrite<log::AscReader, log::AscWriter>(text, [&](log::Entry& entry, const log::Losses& lost) {
    constexpr base::Duration second{1'000'000'000};
    if (first == base::never) {
      const auto since = entry.time.time_since_epoch();
      first = entry.time - (since % second + second) % second;
    }
    if (lost.count(log::Lost::time) != 0) entry.time = std::max(entry.time, first);
    if (lost.count(log::Lost::time_digits) != 0) entry.time -= (entry.time - first) % base::Duration{1000};
    if (lost.count(log::Lost::direction) != 0 && entry.format == can::Format::error)
      entry.direction = log::Direction::unknown;
  });
  return 0;
}
